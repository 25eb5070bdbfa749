"""Our own bicycle files: TOML with the 25 parameters, or with the matrices and the geometry.

    name = "my-bicycle"          # optional, else the file's
    source = "measured by ..."   # optional
    gravity = 9.81               # optional [m/s²]

    [parameters]                 # the 25 of [M07]: w, c, lam, rR, ...
    [rider]                      # optional: mB xB zB IBxx IByy IBzz IBxz, joined to body B

or, where only the linearised equations are known,

    [geometry]                   # wheelbase, trail [m], steer_axis_tilt [rad]
    [matrices]                   # M, C1, K0, K2, each [[φφ, φδ], [δφ, δδ]]
"""

import math
import unicodedata
from collections.abc import Iterable, Mapping

import numpy as np

from bikesim.bicycles.body import BODY_KEYS, RigidBody, with_rider
from bikesim.errors import InputError, unknown
from bikesim.model.bicycle import Bicycle
from bikesim.model.parameters import PARAMETER_NAMES, BicycleParameters
from bikesim.model.whipple import Matrices, Matrix
from bikesim.textfile import parse_toml

Table = Mapping[str, object]

GEOMETRY_KEYS = ("wheelbase", "trail", "steer_axis_tilt")
MATRIX_KEYS = ("M", "C1", "K0", "K2")
_TOP_KEYS = ("name", "source", "gravity", "parameters", "rider", "geometry", "matrices")


def bicycle_from_toml(text: str, *, name: str, source: str) -> Bicycle:
    """The bicycle of a TOML text; `name` and `source` hold where it gives none.

    Raises InputError for unknown or missing keys and values that are not allowed.
    """
    document = _document(text)
    name = _string(document, "name", name)
    source = _string(document, "source", source)
    gravity = _number(document.get("gravity", 9.81), "gravity")
    if "parameters" in document:
        _refuse(document, ("geometry", "matrices"), beside="parameters")
        return Bicycle.from_parameters(
            _parameters(document), name=name, source=source, gravity=gravity
        )
    if "matrices" in document or "geometry" in document:
        _refuse(document, ("rider",), beside="matrices")
        matrices, geometry = _table(document, "matrices"), _numbers(document, "geometry")
        return Bicycle(name, source, _matrices(matrices), *geometry, gravity=gravity)
    if "rider" in document:
        raise InputError("has a rider's part only; give it after a frame, as FRAME+RIDER")
    raise InputError("lacks [parameters], or [matrices] with [geometry]")


def rider_from_toml(text: str) -> RigidBody:
    """The rider of a TOML text that has a [rider] table and no bicycle. Raises InputError."""
    document = _document(text)
    _refuse(document, ("parameters", "geometry", "matrices"), beside="rider")
    return RigidBody(*_numbers(document, "rider"))


def _document(text: str) -> Table:
    document = parse_toml(text)
    _only(document, _TOP_KEYS, "")
    return document


def _parameters(document: Table) -> BicycleParameters:
    frame = BicycleParameters(*_numbers(document, "parameters"))
    if "rider" not in document:
        return frame
    return with_rider(frame, RigidBody(*_numbers(document, "rider")))


_NUMBERS = {"parameters": PARAMETER_NAMES, "rider": BODY_KEYS, "geometry": GEOMETRY_KEYS}


def _numbers(document: Table, section: str) -> list[float]:
    table = _table(document, section)
    keys = _NUMBERS[section]
    _complete(table, keys, section)
    return [_number(table[key], f"[{section}] {key}") for key in keys]


def _matrices(table: Table) -> Matrices:
    _complete(table, MATRIX_KEYS, "matrices")
    return Matrices(*(_matrix(table[key], f"[matrices] {key}") for key in MATRIX_KEYS))


def _matrix(value: object, key: str) -> Matrix:
    rows = value if isinstance(value, list) else []
    if len(rows) != 2 or any(not isinstance(row, list) or len(row) != 2 for row in rows):
        raise InputError(f"{key}: must be 2 x 2 numbers, [[φφ, φδ], [δφ, δδ]]")
    return np.array([[_number(element, key) for element in row] for row in rows])


def _table(document: Table, section: str) -> Table:
    table = document.get(section)
    if table is None:
        raise InputError(f"lacks [{section}]")
    if not isinstance(table, dict):
        raise InputError(f"{section} = {table!r}: must be a table, [{section}]")
    return table


def _complete(table: Table, keys: Iterable[str], section: str) -> None:
    _only(table, keys, f" in [{section}]")
    missing = [key for key in keys if key not in table]
    if missing:
        raise InputError(f"[{section}] lacks {', '.join(missing)}")


def _only(table: Table, keys: Iterable[str], place: str) -> None:
    for key in table:
        if key not in keys:
            raise unknown(f"key{place}", key, keys)


def _refuse(document: Table, sections: Iterable[str], *, beside: str) -> None:
    for section in sections:
        if section in document:
            raise InputError(f"[{section}] cannot stand beside [{beside}]")


def _string(document: Table, key: str, default: str) -> str:
    value = document.get(key, default)
    if not isinstance(value, str) or not value.strip():
        raise InputError(f"{key} = {value!r}: must be a text that is not empty")
    if any(unicodedata.category(character) in ("Cc", "Zl", "Zp") for character in value):
        raise InputError(f"{key} = {value!r}: must be one line without control characters")
    return value


def _number(value: object, key: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{key} = {value!r}: must be a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(f"{key} = {number}: must be finite")
    return number
