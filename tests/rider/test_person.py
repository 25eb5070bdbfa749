"""The chain from senses to torque, held against one that is written out here."""

import math
from collections import deque

import numpy as np
import pytest
from scipy.signal import lsim

from bikesim.rider.base import Arms, Rider
from bikesim.rider.settings import RiderSettings
from bikesim.rider.vision import VisionSettings

from .conftest import STEP

HUMAN = RiderSettings(name="human")


def sway(k: int) -> tuple[float, float]:
    return 0.1 * math.sin(0.003 * k), 0.3 * math.cos(0.004 * k)


def ride(rider: Rider, seen, steps: int = 1200, steer: float = 0.0) -> list[float]:
    """The torques, the bicycle shown at every second step."""
    torques, shown = [], seen()
    for k in range(steps):
        if k % 2 == 0:
            shown = seen(*sway(k), time=k * STEP)
        torques.append(rider.torque(steer, 0.0, shown))
    return torques


def test_the_default_rider_is_gains_delay_muscles_and_remnant(make, seen):
    """One written out, with SciPy's muscles: T = G_nm (k_φ φ + k_φ̇ φ̇)(t - τ) + remnant."""
    roll_gain, roll_rate_gain, w, z = 0.43, 1.74, 30.0, 0.707
    line = deque([0.0] * round(0.2 / STEP))
    intended = []
    for k in range(1200):
        roll, roll_rate = sway(k - k % 2)
        line.append(roll_gain * roll + roll_rate_gain * roll_rate)
        intended.append(line.popleft())
    times = STEP * np.arange(1201)
    muscle = ([w * w], [1, 2 * z * w, w * w])
    _, torque, _ = lsim(muscle, [*intended, 0.0], times, interp=False)
    random, decay = np.random.default_rng(1), math.exp(-10.0 * STEP)
    remnant = [0.03 * random.standard_normal()]
    for normal in random.standard_normal(4096)[:1199]:
        remnant.append(decay * remnant[-1] + 0.03 * math.sqrt(1 - decay**2) * normal)
    ours = ride(make("human", seed=1), seen)
    assert ours == pytest.approx(torque[1:] + np.array(remnant), abs=1e-12)


def test_a_display_that_is_late_is_late_on_top_of_his_eyes(make, seen):
    one = make("pd", visual_delay=0.05, vision=VisionSettings(delay=0.03))
    assert ride(one, seen) == ride(make("pd", visual_delay=0.08), seen)


def test_in_the_dark_it_is_the_late_picture_that_stays(make, seen):
    """The display is 0.1 s late and goes dark at 0.2 s: what stays is the bicycle of 0.1 s."""
    vision = VisionSettings(delay=0.1, occlusions=((0.2, 0.4),))
    quick = {"muscle_frequency": 1000.0, "roll_gain": 1.0, "roll_rate_gain": 0.0}
    rider = make("pd", vision=vision, **quick)
    torques = [rider.torque(0.0, 0.0, seen(k * STEP, 0.0, time=k * STEP)) for k in range(1000)]
    assert torques[700] == pytest.approx(0.1, abs=1.1e-3)  # 0.35 s
    assert torques[799] == torques[700]
    assert torques[-1] == pytest.approx(0.4, abs=3e-3)


def test_what_he_feels_is_late_too(make, seen):
    """The identified rider's damping on the steer rate, 0.1 s late and nothing else."""
    damping = {"roll_gain": 0.0, "roll_rate_gain": 0.0, "steer_integral_gain": 0.0}
    quick = {"muscle_frequency": 1000.0, "proprioceptive_delay": 0.1}
    rider = make("schwab2013-184", **damping, **quick)
    torques = [rider.torque(0.0, 1.0, seen()) for _ in range(400)]
    assert torques[:200] == [0.0] * 200
    assert torques[-1] == pytest.approx(-3.0, rel=1e-9)


def test_he_intends_no_more_than_his_limit(make, seen):
    rider = make("pd", torque_limit=0.5)
    torques = [rider.torque(0.0, 0.0, seen(1.0, 0.0)) for _ in range(2000)]
    assert torques[-1] == pytest.approx(0.5, rel=1e-6)
    within = ride(make("pd", torque_limit=100.0), seen)
    assert within == ride(make("pd"), seen)


def test_a_rider_without_muscles_gives_what_he_intends(make, seen):
    rider = make("torque-step", script={"torque": 2.0, "start": 0.1})
    assert set(ride(rider, seen)[:200]) == {0.0}
    assert rider.torque(0.0, 0.0, seen()) == 2.0


class TestNoise:
    SENSES = (
        ("human", "visual_roll_noise"),
        ("human", "visual_roll_rate_noise"),
        ("schwab2013-184", "proprioceptive_steer_noise"),
        ("schwab2013-184", "proprioceptive_steer_rate_noise"),
    )

    @pytest.mark.parametrize(("name", "noise"), SENSES)
    def test_the_remnant_is_the_same_with_it_and_without(self, make, seen, name, noise):
        """So the difference of two seeds is the same: the noise of the senses alone."""
        kinds = ({"remnant_rms": 0.0}, {"remnant_rms": 0.1})
        quiet, loud = (np.array(ride(make(name, seed=4, **kind), seen)) for kind in kinds)
        noisy, both = (
            np.array(ride(make(name, seed=4, **kind, **{noise: 0.05}), seen)) for kind in kinds
        )
        assert np.abs(noisy - quiet).max() > 1e-4
        np.testing.assert_allclose(both - noisy, loud - quiet, atol=1e-12)

    def test_each_sense_has_its_own(self, make, seen):
        """One is the same whether another is there or not."""
        roll, rate = {"visual_roll_noise": 0.05}, {"visual_roll_rate_noise": 0.07}
        plain, one, other, both = (
            np.array(ride(make("human", remnant_rms=0.0, **noise), seen))
            for noise in ({}, roll, rate, roll | rate)
        )
        np.testing.assert_allclose(both - plain, (one - plain) + (other - plain), atol=1e-12)

    def test_it_reaches_the_torque_by_gain_and_muscles(self, make, seen):
        """Slow against the muscles, white enough to average: RMS is the gain's."""
        rider = make("pd", roll_rate_gain=0.0, visual_roll_noise=0.02, visual_noise_bandwidth=3.0)
        torques = [rider.torque(0.0, 0.0, seen()) for _ in range(100_000)]
        assert np.std(torques) == pytest.approx(3.0 * 0.02, rel=0.2)


class TestGrip:
    ARMS = Arms(0.1, 2.0, 5.0)

    @staticmethod
    def at(rider: Rider, seen, time: float) -> float:
        return rider.torque(0.0, 0.0, seen(0.1, 0.0, time=time))

    def test_arms_are_those_of_the_grip(self, make, seen):
        rider = make("human", grips=[[1.0, "tight"], [2.0, "hands-off"], [3.0, "normal"]])
        arms = []
        for time in (0.0, 1.0, 2.0, 3.0):
            self.at(rider, seen, time)
            arms.append(rider.arms)
        assert arms == [self.ARMS, Arms(0.1, 10.0, 200.0), Arms(), self.ARMS]

    def test_arms_are_the_same_object_until_they_change(self, make, seen):
        rider = make("human", grips=[[1.0, "tight"]], tight_damping=12.0)
        before = rider.arms
        self.at(rider, seen, 0.9)
        assert rider.arms is before
        self.at(rider, seen, 1.0)
        tight = rider.arms
        assert tight == Arms(0.1, 12.0, 200.0)
        self.at(rider, seen, 1.1)
        assert rider.arms is tight

    def test_hands_off_there_is_no_torque(self, make, seen):
        rider = make("human", grips=[[0.2, "hands-off"]], remnant_rms=0.1)
        torques = ride(rider, seen, 600)
        assert 0.0 not in torques[:400]
        assert set(torques[400:]) == {0.0}

    def test_hands_that_come_back_begin_with_muscles_at_rest(self, make, seen):
        rider = make("pd", grips=[[0.2, "hands-off"], [0.3, "normal"]])
        torques = [rider.torque(0.0, 0.0, seen(0.1, 0.0, time=k * STEP)) for k in range(700)]
        fresh = make("pd")
        first = [fresh.torque(0.0, 0.0, seen(0.1, 0.0)) for _ in range(100)]
        assert torques[600:] == first

    def test_a_tight_grip_leaves_the_brain_its_torque(self, make, seen):
        tight = ride(make("human", grips=[[0.1, "tight"]]), seen)
        assert tight == ride(make("human"), seen)
