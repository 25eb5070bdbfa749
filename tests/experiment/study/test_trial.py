"""A rider of one's own is tried alone and in a batch before he rides by the thousand."""

from collections.abc import Callable
from pathlib import Path

import pytest

from bikesim.errors import InputError
from bikesim.experiment.study.conduct import try_riders
from bikesim.experiment.study.plan import Study
from bikesim.experiment.study.trial import trials_of
from bikesim.experiment.study.work import Done, Refused, work

from .crews import OwnHands

RIDERS = """
import numpy as np

class Honest:
    def __init__(self, setting, *, gain=8.0):
        self.gain, self.rate_gain = gain, 3.0 + np.sin(setting.speed)
    def intend(self, steer, steer_rate, seen):
        return self.gain * seen.roll + self.rate_gain * seen.roll_rate

class Average(Honest):
    def intend(self, steer, steer_rate, seen):
        return 0.0 * steer + np.mean(super().intend(steer, steer_rate, seen))

class Slow(Honest):
    batch = False
    def intend(self, steer, steer_rate, seen):
        return float(super().intend(steer, steer_rate, seen))

class Shared(Slow):
    asked = 0
    def intend(self, steer, steer_rate, seen):
        Shared.asked += 1
        return super().intend(steer, steer_rate, seen) + 1e-6 * (Shared.asked % 7)

class Where(Honest):
    def intend(self, steer, steer_rate, seen):
        torque = super().intend(steer, steer_rate, seen)
        return np.where(abs(torque) > 2.0, np.sign(torque) * 2.0, torque)

class ManyOnly(Honest):
    def intend(self, steer, steer_rate, seen):
        return super().intend(steer, steer_rate, seen) + 0.0 * len(steer)

class FewOnly(Honest):
    def intend(self, steer, steer_rate, seen):
        assert np.size(steer) == 1
        return super().intend(steer, steer_rate, seen)
"""


@pytest.fixture
def study(make, tmp_path: Path) -> Callable[[str], Study]:
    """An experiment with one of these riders, at two speeds and with two gains."""
    (tmp_path / "riders.py").write_text(RIDERS)
    return lambda name: make(
        f"seeds = 2\nscenario.rider.name = 'riders.py:{name}'\n"
        "[factors]\nspeed = [3.5, 5.0]\n'rider.figures.gain' = [6.0, 8.0]\n"
    )


def tried(study: Study) -> Done | Refused:
    (trial,) = trials_of(study)
    return work(trial, lambda _: False)


@pytest.mark.parametrize("name", ["Honest", "Slow", "Where"])
def test_one_who_does_the_same_passes(study, name: str):
    assert isinstance(tried(study(name)), Done)


@pytest.mark.parametrize("name", ["Average", "Shared"])
def test_one_who_does_not_is_refused(study, name: str):
    answer = tried(study(name))
    assert isinstance(answer, Refused)
    assert f"riders.py:{name} does not ride in a batch as he does alone: after " in answer.why
    assert "in a batch of 3" in answer.why
    assert "\n" not in answer.why


def test_the_line_has_no_run_before_it(study):
    with pytest.raises(InputError, match=r"^rider \S+riders.py:Average does not ride in a batch"):
        try_riders(study("Average"), OwnHands(), lambda: False)


def test_he_rides_with_figures_and_speeds_of_the_grid(study):
    (trial,) = trials_of(study("Honest"))
    rides = [(one.speed, one.rider.figures, one.duration) for one in trial.scenarios]
    assert rides == [(3.5, {"gain": 6.0}, 1.0), (3.5, {"gain": 8.0}, 1.0), (5.0, {"gain": 8.0}, 1)]


def test_one_who_cannot_ride_alone_is_refused(study):
    answer = tried(study("ManyOnly"))
    assert isinstance(answer, Refused)
    assert "riders.py:ManyOnly raised TypeError at 0.0000 s (riders.py, line " in answer.why


def test_what_he_does_wrong_in_a_batch_is_left_to_the_ride(study):
    assert isinstance(tried(study("FewOnly")), Done)


def test_riders_that_ship_are_not_tried(small):
    assert trials_of(small) == []
