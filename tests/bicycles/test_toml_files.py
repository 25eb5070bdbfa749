from dataclasses import replace

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.errors import InputError

MATRICES = """
[geometry]
wheelbase = 1.0
trail = 0.05
steer_axis_tilt = 0.3

[matrices]
M = [[80, 2], [2, 0.3]]
C1 = [[0, 30], [-0.8, 1.6]]
K0 = [[-80, -2.6], [-2.6, -0.8]]
K2 = [[0, 76], [0, 2.6]]
"""
RIDER = """
[rider]
mB = 72.0
xB = 0.2909
zB = -1.1091
IBxx = 7.9985
IBxz = -1.9272
IByy = 8.0689
IBzz = 2.3624
"""


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Writes a text to b.toml in the working folder."""
    monkeypatch.chdir(tmp_path)
    return lambda text, name="b.toml": (tmp_path / name).write_text(text, encoding="utf-8")


def refusal(name: str = "b.toml") -> str:
    with pytest.raises(InputError) as caught:
        bicycles.load(name)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def pista() -> str:
    return bicycles.to_toml(bicycles.load("pista"))


def test_name_source_and_gravity_have_defaults(written):
    written(MATRICES)
    bicycle = bicycles.load("b.toml")
    assert (bicycle.name, bicycle.source, bicycle.gravity) == ("b", "file b.toml", 9.81)


def test_matrices_and_geometry_are_read(written):
    written("gravity = 9.8\n" + MATRICES)
    bicycle = bicycles.load("b.toml")
    assert bicycle.gravity == 9.8
    assert (bicycle.wheelbase, bicycle.trail, bicycle.steer_axis_tilt) == (1.0, 0.05, 0.3)
    np.testing.assert_array_equal(bicycle.matrices.C1, [[0, 30], [-0.8, 1.6]])


def test_a_rider_table_is_joined_to_the_frame(written, shared):
    folder = shared / "reference/bicycles"
    frame = bicycles.to_toml(bicycles.load(folder / "BrowserBenchmark.txt"))
    written(frame + RIDER)
    merged = bicycles.load(f"{folder}/BrowserBenchmark.txt+{folder}/JasonBrowserBenchmark.txt")
    assert bicycles.load("b.toml").parameters == merged.parameters


def test_a_toml_rider_file_goes_on_a_frame(written):
    written('name = "Jason"\n' + RIDER, "jason.toml")
    parameters = bicycles.load("pista+jason.toml").parameters
    assert parameters is not None
    assert parameters.mB == 76.49 + 72.0


def test_a_toml_rider_alone_is_no_bicycle(written):
    written(RIDER)
    assert refusal() == "b.toml: has a rider's part only; give it after a frame, as FRAME+RIDER"


def test_a_toml_bicycle_is_no_rider(written):
    written(pista() + RIDER)
    assert "[parameters] cannot stand beside [rider]" in refusal("pista+b.toml")


def test_a_text_with_quotes_is_written_back(written):
    odd = replace(bicycles.load("davis"), source='a "b" \\ c é φ')
    written(bicycles.to_toml(odd))
    assert bicycles.load("b.toml").source == odd.source


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("trail = 0.05", "trial = 0.05", "unknown key in [geometry] 'trial'; did you mean trail?"),
        ("trail = 0.05", "", "[geometry] lacks trail"),
        ("trail = 0.05", "trail = nan", "[geometry] trail = nan: must be finite"),
        ("trail = 0.05", "trail = true", "[geometry] trail = True: must be a number"),
        ("trail = 0.05", "trail = '1'", "[geometry] trail = '1': must be a number"),
        ("trail = 0.05", f"trail = 1{'0' * 400}", "[geometry] trail = inf: must be finite"),
        ("wheelbase = 1.0", "wheelbase = 0", "bicycle b: wheelbase = 0.0: must be above 0"),
        ("M = [[80, 2], [2, 0.3]]", "M = [[80, 2]]", "[matrices] M: must be 2 x 2 numbers"),
        ("M = [[80, 2], [2, 0.3]]", "M = 3", "[matrices] M: must be 2 x 2 numbers"),
        ("[2, 0.3]", "[2, 0.01]", "mass matrix M = "),
        ("[2, 0.3]", "[2, inf]", "[matrices] M = inf: must be finite"),
        ("[matrices]", "[matrixes]", "unknown key 'matrixes'; did you mean matrices"),
        ("[geometry]", "gravity = 1e3\n[geometry]", "bicycle b: gravity = 1000.0: from 0 to 100"),
        ("[geometry]", "gravity = 'g'\n[geometry]", "gravity = 'g': must be a number"),
        ("[geometry]", "name = 3\n[geometry]", "name = 3: must be a text"),
        ("[geometry]", "rider = 3\n[geometry]", "[rider] cannot stand beside [matrices]"),
        ("[geometry]", "[geometry", "not TOML: "),
        ("trail = 0.05", "trail = 0.05\ntrail = 0.05", "not TOML: "),
    ],
)
def test_a_bad_value_is_named_with_the_file(written, old, new, message):
    assert old in MATRICES
    written(MATRICES.replace(old, new))
    assert refusal().startswith(f"b.toml: {message}")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("mH = 2.27", "mH = 0", "bicycle parameter mH = 0.0: must be above 0"),
        ("IFxx = ", "IFx = ", "unknown key in [parameters] 'IFx'"),
        ("[parameters]", "[[parameters]]", "parameters = "),
    ],
)
def test_a_bad_parameter_is_named_with_the_file(written, old, new, message):
    written(pista().replace(old, new))
    assert refusal().startswith(f"b.toml: {message}")


def test_parameters_exclude_matrices(written):
    written(pista() + MATRICES)
    assert refusal() == "b.toml: [geometry] cannot stand beside [parameters]"


def test_geometry_needs_matrices(written):
    written(MATRICES.split("[matrices]", maxsplit=1)[0])
    assert refusal() == "b.toml: lacks [matrices]"


def test_a_toml_without_a_bicycle(written):
    written('name = "x"')
    assert refusal() == "b.toml: lacks [parameters], or [matrices] with [geometry]"


def test_a_mass_matrix_that_is_not_positive_definite_names_the_file(written):
    written(MATRICES.replace("[2, 0.3]", "[2, 0.05]"))
    message = refusal()
    assert message.startswith("b.toml: mass matrix M")
    assert message.endswith("must be positive definite")


@pytest.mark.parametrize("character", ["\\u0000", "\\n", "\\u001b", "\\u2028"])
@pytest.mark.parametrize("key", ["name", "source"])
def test_a_control_character_is_refused(written, key: str, character: str):
    written(f'{key} = "a{character}b"\n' + MATRICES)
    assert f"{key} = " in refusal()
    assert "must be one line without control characters" in refusal()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("80, 2", "1e200, 2", "matrix M = "),
        ("76", "1e10", "must be within ±1e+09"),
        ("[[80, 2], [2, 0.3]]", "[[1e-150, 0], [0, 1e-150]]", "at least 1e-09 on its diagonal"),
        ("wheelbase = 1.0", "wheelbase = 1e-300", "wheelbase = 1e-300: from 0.001 to 100 m"),
        ("trail = 0.05", "trail = 1e150", "trail = 1e+150: from -100 to 100 m"),
    ],
)
def test_what_is_far_beyond_any_bicycle_is_refused(written, old: str, new: str, message: str):
    written(MATRICES.replace(old, new))
    assert message in refusal()
