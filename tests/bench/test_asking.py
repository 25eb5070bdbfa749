import math

import pytest

from bikesim.bench.asking import AWAY, HELD, STILL, STRAIGHT, TURNED, Asking
from bikesim.bench.plant import Plant
from bikesim.bench.scenario import bench_scenario

from .lockstep import leaning, profile

PERIOD = 0.01  # s
LONG = 300  # periods
HOLD, TURN = [0.0] * 120, [1.5 * TURNED] * 30
GOOD = [*HOLD, *TURN, *HOLD]


def asked_after(angles: list[float], good: list[bool] | None = None) -> float | None:
    """When [s] a bar asks that stands at these angles [rad], one a period."""
    asking = Asking()
    for row, steer in enumerate(angles):
        if asking(row * PERIOD, steer, good=good is None or good[row]):
            return row * PERIOD
    return None


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("off", [0.0, 0.9])
def test_held_straight_turned_and_held_straight_again(side: int, off: float):
    angles = [off * STRAIGHT + side * angle for angle in GOOD]
    assert asked_after(angles) == pytest.approx((120 + 30) * PERIOD + HELD, abs=2 * PERIOD)


@pytest.mark.parametrize(
    "angles",
    [
        [0.0] * LONG,  # nobody there
        [*TURN, *HOLD, *HOLD],  # where it was left, and brought back
        [*HOLD, *HOLD, *TURN],
        [*HOLD, *[1.5 * TURNED] * round(0.9 * AWAY / PERIOD), *HOLD],  # pushed by accident
        [*HOLD, *[0.95 * TURNED] * 50, *HOLD],
        [*HOLD, *TURN, *[1.05 * STRAIGHT] * LONG],
        [*HOLD, *TURN, *[0.9 * STILL * (-1) ** (k // 20) for k in range(LONG)]],  # swings
        [*HOLD, *TURN, *([0.0] * 90 + [1.05 * STRAIGHT]) * 4],  # never for long
    ],
    ids=range(8),
)
def test_whoever_did_not_do_so_did_not_ask(angles: list[float]):
    assert asked_after(angles) is None


@pytest.mark.parametrize("when", [60, 130, 200])
def test_what_was_not_seen_was_not_done(when: int):
    """A sensor that fails meanwhile, or a host that was stopped."""
    good = [row != when for row in range(len(GOOD))]
    assert asked_after(GOOD, good) is None
    asking = Asking()
    late = [asking(row * PERIOD + (row >= when), steer) for row, steer in enumerate(GOOD)]
    assert not any(late)


def test_a_coarse_encoder_is_still_where_its_angle_is():
    """A count to and fro: some rad/s from one look to the next."""
    count = 2 * math.pi / 4096
    angles = [angle + count * (row % 2) for row, angle in enumerate(GOOD)]
    assert asked_after(angles) is not None


def test_an_emulated_rider_asks_when_he_is_asked():
    bench = profile()
    plant = Plant(bench, bench_scenario(bench, leaning()), quantum=0.001)

    def asks(seconds: float) -> float | None:
        asking = Asking()
        for tick in range(round(1000 * seconds)):
            plant.advance()
            if asking(tick / 1000, plant.steer):
                return tick / 1000
        return None

    plant.ask(asked=False)
    assert asks(6.0) is None
    plant.ask(asked=True)
    first = asks(6.0)
    assert first is not None
    assert math.degrees(abs(plant.steer)) < 1.0
    plant.ask(asked=True)  # he has done so
    assert asks(6.0) is None
    plant.ask(asked=False)
    plant.ask(asked=True)
    assert asks(6.0) == pytest.approx(first, abs=0.2)
