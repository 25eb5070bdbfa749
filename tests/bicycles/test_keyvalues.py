import math

import pytest

from bikesim.bicycles.keyvalues import parse_key_values
from bikesim.errors import InputError


def test_humancontrol_lines():
    assert parse_key_values("w=1.02\nc=-8e-2\n", "f").values == {"w": 1.02, "c": -0.08}


def test_bicycleparameters_lines_keep_the_uncertainty():
    read = parse_key_values("w = 1.121+/-0.002\nc = 0.07\n", "f")
    assert read.values == {"w": 1.121, "c": 0.07}
    assert read.uncertainties == {"w": 0.002}


def test_uncertainties_of_a_measured_file(shared):
    text = (shared / "reference/bicycles/RigidBenchmark.txt").read_text()
    assert parse_key_values(text, "f").uncertainties["mS"] == 0.01


def test_blank_lines_comments_and_windows_ends_are_passed_over():
    assert parse_key_values("# a\r\n\r\n% b\r\n w = 1 \r\n", "f").values == {"w": 1.0}


def test_a_part_of_pi():
    assert parse_key_values("lam=pi/10", "f").values["lam"] == pytest.approx(math.pi / 10)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("w=1\nz", "f, line 2: 'z' is not `key = value`"),
        ("w=1\n\nc=0,08", "f, line 3: c = '0,08': must be a finite number"),
        ("c=", "f, line 1: c = '': must be a finite number"),
        ("c=nan", "f, line 1: c = 'nan': must be a finite number"),
        ("c=-inf", "f, line 1: c = '-inf': must be a finite number"),
        ("lam=pi/0", "f, line 1: lam = 'pi/0': must be a finite number"),
        ("c=1+/-x", "f, line 1: uncertainty of c = 'x': must be a finite number"),
        ("w=1\nc=2\nw=1", "f, line 3: w is given twice (first in line 1)"),
    ],
)
def test_a_bad_line_is_named(text, message):
    with pytest.raises(InputError) as caught:
        parse_key_values(text, "f")
    assert str(caught.value) == message
