import math

import numpy as np
import pytest

from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law

from .conftest import LAWS, Measured, rides


class TestBatch:
    @pytest.mark.parametrize("law", [*LAWS, Law.OFF])
    def test_arrays_give_what_floats_give(self, benchmark: Bicycle, law: Law):
        haptic, seeds = HapticBicycle(benchmark, law), (11, 12, 13)
        time = Measured(10).time.tolist()

        def alone(seed: int) -> BicycleState:
            measured = Measured(seed)
            measured.time = np.array(time)
            return rides(haptic, measured, roll=0.01 * seed)[-1]

        def column(name: str, k: int) -> np.ndarray:
            return np.array([getattr(Measured(seed), name)[k] for seed in seeds])

        together = haptic.start(
            time=time[0],
            roll=np.array([0.01 * seed for seed in seeds]),
            steer=column("steer", 0),
            steer_rate=column("steer_rate", 0),
            speed=column("speed", 0),
            roll_moment=column("roll_moment", 0),
        )
        names = ("steer", "steer_rate", "speed", "roll_moment")
        for k in range(1, len(time)):
            values: list = [column(name, k) for name in names]
            together = haptic.step(together, time[k], *values)

        for i, seed in enumerate(seeds):
            state = alone(seed)
            batch = BicycleState(*(np.broadcast_to(value, 3)[i] for value in together))
            # numpy's sine may differ from the system's in the last digit.
            assert (batch.x, batch.y) == pytest.approx((state.x, state.y), abs=1e-12)
            assert batch._replace(x=0, y=0) == state._replace(x=0, y=0)

    def test_a_speed_for_all_is_the_same_as_one_each(self, benchmark: Bicycle):
        haptic = HapticBicycle(benchmark, Law.PAPER)
        steer, speeds = np.array([0.1, -0.1]), np.array([4.0, 4.0])
        start: BicycleState = haptic.start(speed=4.0)
        shared, own = (haptic.step(start, 0.01, steer, 0 * steer, speed) for speed in (4.0, speeds))
        assert np.array_equal(shared.roll, own.roll)
        assert np.array_equal(shared.feedback_torque, own.feedback_torque)


def test_two_rides_on_one_bicycle_do_not_meet(benchmark: Bicycle):
    haptic = HapticBicycle(benchmark, Law.MOMENTUM)
    first, second = haptic.start(roll=0.1), haptic.start(roll=-0.2)
    alone = haptic.step(first, 0.01, 0.1, 1.0, 4.0)
    haptic.step(second, 0.02, -0.1, 2.0, 6.0)
    assert haptic.step(first, 0.01, 0.1, 1.0, 4.0) == alone


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", ["steer", "steer_rate", "speed", "time"])
@pytest.mark.parametrize("law", list(Law))
def test_an_impossible_sample_gives_a_torque_that_is_not_finite(
    benchmark: Bicycle, law: Law, name: str, value: float
):
    """And no exception: the guard refuses it."""
    haptic = HapticBicycle(benchmark, law)
    sample = {"time": 0.001, "steer": 0.01, "steer_rate": 0.1, "speed": 4.0, name: value}
    state = haptic.step(haptic.start(speed=4.0), **sample)
    assert not math.isfinite(state.feedback_torque)


@pytest.mark.parametrize("law", list(Law))
def test_a_huge_sample_raises_nothing(benchmark: Bicycle, law: Law):
    haptic = HapticBicycle(benchmark, law)
    state = haptic.step(haptic.start(), 0.001, 1e300, -1e300, 1e300)
    assert not abs(haptic.step(state, 0.002, 0.0, 0.0, 0.0).roll) < 1e9
