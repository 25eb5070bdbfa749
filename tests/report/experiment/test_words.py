import math

import pytest

from bikesim.experiment.metric_table import BY_NAME
from bikesim.report.experiment.words import headed, interval, number, p_value, percent, unbroken


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.2345, "1.23"), (0.012345, "0.0123"), (123.45, "123"), (99.96, "100"), (9.996, "10.0"),
        (0, "0"), (-0.5, "−0.500"), (1e-9, "1.00e−09"), (12345.0, "12300"), (math.nan, "–"),
        (math.inf, "∞"), (-math.inf, "−∞"),
    ],
)  # fmt: skip
def test_number(value: float, text: str):
    assert number(value) == text


@pytest.mark.parametrize(
    ("share", "text"), [(0, "0"), (1, "100"), (0.5, "50"), (0.0713, "7.1"), (-0.2, "−20")]
)
def test_percent(share: float, text: str):
    assert percent(share) == text


@pytest.mark.parametrize(
    ("p", "text"),
    [(1e-9, "< 0.001"), (0.0123, "0.012"), (0.5, "0.50"), (1, "1.00"), (math.nan, "–")],
)
def test_p(p: float, text: str):
    assert p_value(p) == text


def test_interval():
    assert interval(1.5, 1.25, 2.0, factor=2) == "<span>3.00</span> <span>[2.50, 4.00]</span>"
    assert interval(1.5, math.nan, math.nan) == "<span>1.50</span>"
    assert interval(math.nan, 0, 1) == "–"


def test_metrics_are_headed_in_the_unit_that_is_shown():
    assert headed(BY_NAME["roll_rms"]) == "roll RMS [deg]"
    assert headed(BY_NAME["fell"]) == "fell"


def test_a_unit_stays_with_its_number():
    told = "off against 2 m, where speed 2.5 m/s, roll cue on"
    assert unbroken(told) == "off against 2\xa0m, where speed 2.5\xa0m/s, roll cue on"
