import math

import pytest

from bikesim.bench.asking import HELD, STILL, STRAIGHT, TURNED, Asking
from bikesim.bench.plant import Plant
from bikesim.bench.scenario import bench_scenario

from .lockstep import leaning, profile

PERIOD = 0.01  # s


def asked_after(motion: list[tuple[float, float]]) -> float | None:
    """When [s] a bar asks that moves like this: angle [rad], rate [rad/s], a row a period."""
    asking = Asking()
    for row, (steer, rate) in enumerate(motion):
        if asking(row * PERIOD, steer, rate):
            return row * PERIOD
    return None


@pytest.mark.parametrize("side", [-1, 1])
def test_turned_and_then_held_straight(side: int):
    turned = [(side * 1.01 * TURNED, 0.0)]
    straight = [(0.9 * side * STRAIGHT, -0.9 * STILL)] * 300
    assert asked_after(turned + straight) == pytest.approx(PERIOD + HELD, abs=PERIOD)


@pytest.mark.parametrize(
    "motion",
    [
        [(0.0, 0.0)] * 1000,  # nobody there
        [(0.99 * TURNED, 0.0)] + [(0.0, 0.0)] * 1000,  # pushed by accident
        [(2 * TURNED, 0.0)] * 1000,  # left at a side
        [(TURNED, 0.0)] + [(1.01 * STRAIGHT, 0.0)] * 1000,
        [(TURNED, 0.0)] + [(0.0, 1.01 * STILL)] * 1000,
        [(TURNED, 0.0)] + ([(0.0, 0.0)] * 90 + [(0.0, -1.01 * STILL)]) * 10,  # never for long
    ],
)
def test_whoever_did_not_do_so_did_not_ask(motion: list[tuple[float, float]]):
    assert asked_after(motion) is None


def test_an_emulated_rider_asks_when_he_is_asked():
    bench = profile()
    plant = Plant(bench, bench_scenario(bench, leaning()), quantum=0.001)

    def asks(seconds: float) -> float | None:
        asking = Asking()
        for tick in range(round(1000 * seconds)):
            plant.advance()
            if asking(tick / 1000, plant.steer, plant.node.steer_rate):
                return tick / 1000
        return None

    plant.ask(asked=False)
    assert asks(4.0) is None
    plant.ask(asked=True)
    first = asks(4.0)
    assert first is not None
    assert math.degrees(abs(plant.steer)) < 1.0
    plant.ask(asked=True)  # he has done so
    assert asks(4.0) is None
    plant.ask(asked=False)
    plant.ask(asked=True)
    assert asks(4.0) == pytest.approx(first, abs=0.2)
