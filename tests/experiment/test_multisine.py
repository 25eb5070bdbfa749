import math
from typing import Any

import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.experiment.disturbances import Disturbance, harmonics
from bikesim.experiment.multisine import Multisine

PERIOD = 1e-2


def _settings(**figures: Any) -> Disturbance:
    return Disturbance(**{"kind": "roll-multisine", **figures})


def _multisine(**figures: Any) -> Multisine:
    return Multisine(_settings(**figures), PERIOD, np.random.default_rng(1))


def _torque(multisine: Multisine, seconds: float) -> np.ndarray:
    return multisine(np.linspace(0.0, seconds, round(seconds / PERIOD), endpoint=False))


def test_its_power_lies_in_its_lines_alone():
    multisine = _multisine(torque_rms=2.0, lines=5, repeat=20.0, lowest=1.0, highest=15.0)
    spectrum = np.abs(np.fft.rfft(_torque(multisine, 20.0))) / 1000
    lines = np.array(harmonics(_settings(lines=5, repeat=20.0, lowest=1.0, highest=15.0)))
    assert spectrum[lines] == pytest.approx(2.0 * math.sqrt(2 / 5))
    assert np.delete(spectrum, lines) == pytest.approx(0, abs=1e-12)
    assert multisine.frequencies == pytest.approx(2 * np.pi / 20 * lines)


@pytest.mark.parametrize("phases", ["random", "schroeder"])
def test_its_root_mean_square(phases: str):
    torque = _torque(_multisine(torque_rms=3.0, phases=phases), 60.0)
    assert np.sqrt(np.mean(torque**2)) == pytest.approx(3.0)


def test_it_repeats():
    torque = _torque(_multisine(repeat=12.0), 24.0)
    assert torque[:1200] == pytest.approx(torque[1200:], abs=1e-10)


def test_it_begins_and_stops():
    multisine = _multisine(start=2.0, stop=5.0)
    torque = _torque(multisine, 8.0)
    assert np.flatnonzero(torque).min() == 200
    assert np.flatnonzero(torque).max() == 499
    assert torque[200] == pytest.approx(multisine.amplitude * np.sin(multisine.phases).sum())


def test_schroeders_phases_have_a_low_crest():
    """[Schroeder 1970]: for lines in a row the crest factor lies near that of a swept sine, far
    below that of sines that all begin at zero."""
    figures = {"lines": 40, "repeat": 40.0, "lowest": 2 * np.pi / 40, "highest": 2 * np.pi}
    multisine = _multisine(**figures, phases="schroeder", torque_rms=1.0)
    assert np.abs(_torque(multisine, 40.0)).max() < 2.0
    assert multisine.phases[:4] == pytest.approx(-np.pi / 40 * np.array([0, 2, 6, 12]))


class TestHarmonics:
    def test_are_even_in_the_logarithm(self):
        lines = np.array(harmonics(_settings(lines=8, lowest=1.0, highest=20.0, repeat=100.0)))
        assert np.diff(np.log(lines)) == pytest.approx(math.log(20) / 7, abs=0.07)
        assert lines[[0, -1]] * 2 * np.pi / 100 == pytest.approx([1, 20], rel=0.04)

    def test_are_each_another(self):
        lines = harmonics(_settings(lines=10, lowest=0.1, highest=2 * np.pi, repeat=12.0))
        assert sorted(set(lines)) == lines

    def test_one_is_the_lowest(self):
        assert harmonics(_settings(lines=1, lowest=2.0, highest=9.0, repeat=10 * np.pi)) == [10]


@pytest.mark.parametrize(
    ("figures", "told"),
    [
        ({"kind": "storm"}, "unknown disturbances.kind 'storm'; known: roll-multisine"),
        ({"kind": "gust", "lines": 3}, "disturbances.lines = 3: kind gust has no such figure"),
        ({"lines": 0}, "disturbances.lines = 0: must be at least 1"),
        ({"start": 5.0, "stop": 5.0}, "stop = 5.0 s: must come after start = 5.0 s"),
        ({"lowest": 9.0, "highest": 8.0}, "disturbances.highest = 8.0 rad/s: must be at least"),
        ({"lines": 100}, "disturbances.lines = 100: of the multiples of 2π / 30 s only 93 lie"),
        ({"kind": "gust", "wind_peek": 3.0}, "unknown key of [disturbances] 'wind_peek'; did you"),
    ],
)
def test_refused_in_one_line(figures: dict[str, Any], told: str):
    with pytest.raises(InputError) as refused:
        _settings(**figures)
    assert str(refused.value).startswith(told)


def test_a_kind_must_be_given():
    with pytest.raises(InputError, match=r"^disturbances\.kind: must be given$"):
        Disturbance()  # pyright: ignore[reportCallIssue]
