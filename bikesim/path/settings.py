"""Which path is prescribed: its kind, and every figure that a user may set."""

from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, Strict, model_validator

from bikesim.errors import InputError
from bikesim.settings import Settings, of_kind

_Length = Annotated[float, Field(ge=0.5, le=1e4)]
_Run = Annotated[float, Field(ge=0, le=1e4)]
_Offset = Annotated[float, Field(ge=-100, le=100)]
_Coordinate = Annotated[float, Field(ge=-1e5, le=1e5)]
# TOML has lists, not tuples.
_List = Strict(False)
_Point = Annotated[tuple[_Coordinate, _Coordinate], _List]

# The figures of each kind, with their defaults; those of double-lane-change have the proportions
# of ISO 3888-2 (12, 13.5, 11, 12.5, 12 m).
_KINDS: dict[str, dict[str, Any]] = {
    "straight": {},
    "lane-change": {"start": 20.0, "offset": 2.0, "length": 20.0, "back": False, "hold": 20.0},
    "double-lane-change": {
        "start": 12.0, "offset": 2.0, "length": 13.5, "hold": 11.0, "return_length": 12.5,
    },
    "slalom": {"start": 20.0, "amplitude": 1.0, "wavelength": 25.0, "count": 6},
    "circle": {"start": 20.0, "radius": 20.0, "side": "right", "entry": 10.0},
    "figure-eight": {"start": 20.0, "radius": 10.0, "side": "right"},
    "csv": {"file": None, "points": None},
}  # fmt: skip
PATH_KINDS = tuple(_KINDS)


class PathSettings(Settings):
    """The prescribed path: a kind, and the figures that a path of that kind has, the rest None.

    It begins at the origin along +x, where the bicycle starts. Made from a `kind` alone it has the
    figures of that kind; those given beside it replace them. A path from a file keeps its points,
    so that a record has all that was ridden.
    """

    table: ClassVar[str] = "path"

    kind: str = Field(
        default="straight",
        description="straight, lane-change, double-lane-change, slalom, circle, figure-eight, csv.",
    )
    start: _Run | None = Field(
        default=None,
        description="Straight on before it begins [m]; default: 20, double-lane-change 12.",
    )
    offset: _Offset | None = Field(
        default=None,
        description="Of the lane changed to, to the right [m]; default: 2.",
    )
    length: _Length | None = Field(
        default=None,
        description="Of the change of lane, forward [m]; default: 20, double-lane-change 13.5.",
    )
    back: bool | None = Field(
        default=None, description="Whether a lane-change comes back; default: false."
    )
    hold: _Run | None = Field(
        default=None,
        description="Stay in the other lane [m]; default: 20, double-lane-change 11.",
    )
    return_length: _Length | None = Field(
        default=None, description="Of the double-lane-change's way back [m]; default: 12.5."
    )
    amplitude: _Offset | None = Field(
        default=None,
        description="Of the slalom, the first bend to the right [m]; default: 1.",
    )
    wavelength: _Length | None = Field(
        default=None, description="Of the slalom, of two bends [m]; default: 25."
    )
    count: Annotated[int, Field(ge=1, le=1000)] | None = Field(
        default=None, description="Bends of the slalom; default: 6."
    )
    radius: Annotated[float, Field(ge=2, le=1e4)] | None = Field(
        default=None,
        description="Of the circle; the smallest of the figure-eight [m]; default: 20, 10.",
    )
    side: Literal["right", "left"] | None = Field(
        default=None, description="Where circle and figure-eight turn first; default: right."
    )
    entry: _Length | None = Field(
        default=None,
        description="Over which the circle's curvature sets in [m]; default: 10.",
    )
    file: str | None = Field(
        default=None,
        description="Of the csv: columns x, y [m], x forward, y to the right; default: none.",
    )
    points: Annotated[tuple[_Point, ...], _List] | None = Field(
        default=None,
        description="Of the csv, in place of a file: pairs of x and y [m]; default: the file's.",
    )

    @model_validator(mode="before")
    @classmethod
    def _by_kind(cls, given: Any) -> Any:
        if isinstance(given, str):
            given = {"kind": given}
        if not isinstance(given, dict) or not isinstance(given.get("kind", ""), str):
            return given
        given = {key: value for key, value in given.items() if value is not None}
        if (kind := given.get("kind", "")) not in _KINDS and "." in kind:
            # A file's name will do in place of a kind.
            given = {**given, "kind": "csv", "file": kind}
        return _with_points(of_kind({"kind": "straight", **given}, cls, _KINDS))

    @model_validator(mode="after")
    def _can_be_ridden(self) -> "PathSettings":
        if self.kind != "straight":
            from bikesim.path.building import make_path

            make_path(self)
        return self


def _with_points(given: dict[str, Any]) -> dict[str, Any]:
    """Of a csv, the points of its file, unless they are there already."""
    if given["kind"] != "csv" or given["points"] is not None:
        return given
    if given["file"] is None:
        raise InputError("path: of kind csv: file must be given, a text file of columns x, y [m]")
    if not isinstance(given["file"], str):
        return given
    from bikesim.path.csv_file import read_points

    return {**given, "points": read_points(Path(given["file"]))}
