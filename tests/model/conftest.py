"""Bicycles of the tests of the mathematics."""

import math

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law
from bikesim.model.whipple import Matrices


@pytest.fixture(scope="session")
def benchmark() -> Bicycle:
    """[M07], g = 9.81."""
    return bicycles.load("benchmark")


@pytest.fixture(scope="session")
def damped_roll() -> Bicycle:
    """A bicycle known by matrices, unlike any Whipple bicycle in that C_φφ is not zero."""
    return Bicycle(
        name="damped roll",
        source="made up",
        matrices=Matrices(
            M=np.array([[80.0, 2.3], [2.3, 0.3]]),
            C1=np.array([[1.7, 33.0], [-0.9, 1.6]]),
            K0=np.array([[-81.0, -2.5], [-2.5, -0.8]]),
            K2=np.array([[0.4, 76.0], [0.1, 2.6]]),
        ),
        wheelbase=1.0,
        trail=0.07,
        steer_axis_tilt=math.pi / 10,
    )


LAWS = [Law.PAPER, Law.MOMENTUM]


class Measured:
    """Samples at uneven times; between them steer, rate and roll moment are straight lines."""

    def __init__(self, seed: int, samples: int = 40, longest: float = 0.03) -> None:
        random = np.random.default_rng(seed)
        self.time = np.cumsum(random.uniform(1e-4, longest, samples)).round(6)
        self.steer, self.steer_rate = random.uniform(-0.3, 0.3, (2, samples))
        self.roll_moment = random.uniform(-40, 40, samples)
        self.speed = random.uniform(0, 10, samples)


def rides(haptic: HapticBicycle, measured: Measured, **start: float) -> list[BicycleState]:
    rows = list(
        zip(
            *(
                values.tolist()
                for values in (
                    measured.time, measured.steer, measured.steer_rate, measured.speed,
                    measured.roll_moment,
                )
            ),
            strict=True,
        )
    )  # fmt: skip
    time, steer, steer_rate, speed, moment = rows[0]
    states = [
        haptic.start(
            time=time, steer=steer, steer_rate=steer_rate, speed=speed, roll_moment=moment, **start
        )
    ]
    for row in rows[1:]:
        states.append(haptic.step(states[-1], *row))
    return states
