"""Hess's rider against what was published of him, and against his model as one linear system."""

import csv
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import signal

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import Scenario, StartSettings
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.path.building import make_path
from bikesim.path.path import straight_path
from bikesim.path.settings import PathSettings
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import Ending
from bikesim.rider.base import Setting, Sight
from bikesim.rider.hess2012 import PREVIEW, Hess2012
from bikesim.rider.hess_gains import Gains, published_gains
from bikesim.rider.hess_loops import crossovers, handling_quality, linear_hess
from bikesim.rider.linear import closed_loop, spectral_abscissa
from bikesim.rider.settings import RiderSettings

SPEEDS = (3.2, 3.9, 4.8, 5.0, 6.3, 8.0, 9.5, 12.0)
AT_5 = Gains(46.5457, -0.0522, 12.6611, 0.1849, 0.0959)


@pytest.fixture(scope="module")
def benchmark() -> Bicycle:
    return bicycles.load("benchmark")


def setting(bicycle: Bicycle, **changed: Any) -> Setting:
    usual = {
        "law": Law.PAPER, "inertia": 0.23, "speed": 5.0, "step": 1e-3, "path": straight_path(),
    }  # fmt: skip
    return Setting(bicycle, **{**usual, **changed})


def sight(**given: float) -> Sight:
    return Sight(**{**dict.fromkeys(Sight._fields, 0.0), "speed": 5.0, **given})


def test_gains_at_a_published_speed_are_those(benchmark: Bicycle):
    assert published_gains(benchmark, 5.0) == AT_5


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("benchmark", "Benchmark"),
        ("browser", "Browser"),
        ("pista", "Pista"),
        ("rigid-early", "Rigid"),
    ],
)
def test_gains_are_those_of_the_files(shared: Path, name: str, file: str):
    text = (shared / "reference" / "rider_gains" / f"hess_{file}.csv").read_text()
    stale = {("benchmark", 2.5), ("rigid-early", 3.2), ("rigid-early", 7.0)}
    rows = [[float(word) for word in row] for row in list(csv.reader(text.splitlines()))[1:]]
    bicycle = bicycles.load(name)
    kept = [row for row in rows if (name, row[0]) not in stale]
    assert len(kept) >= 3
    for speed, *gains in kept:
        assert published_gains(bicycle, speed) == pytest.approx(gains, rel=1e-12)


def test_gains_of_an_array_of_speeds_are_those_of_each(benchmark: Bicycle):
    many = published_gains(benchmark, np.array(SPEEDS))
    for i, speed in enumerate(SPEEDS):
        assert [float(gain[i]) for gain in many] == list(published_gains(benchmark, speed))


@pytest.mark.parametrize("speed", [2.5, 3.19, 12.01, math.inf])
def test_outside_the_published_speeds_there_are_none(benchmark: Bicycle, speed: float):
    with pytest.raises(InputError, match=r"speed = .* benchmark are for 3\.2 to 12 m/s"):
        published_gains(benchmark, speed)
    with pytest.raises(InputError, match=r"3\.2 to 12 m/s"):
        Hess2012(setting(benchmark, speed=speed))


def test_another_bicycle_has_none_but_may_be_given_all(benchmark: Bicycle):
    own = bicycles.load("benchmark").with_gravity(9.81)
    own = type(own)(**{**own.__dict__, "name": "mine"})
    with pytest.raises(InputError, match="no gains are published for bicycle mine"):
        Hess2012(setting(own))
    keys = ("k_delta", "k_phi_dot", "k_phi", "k_psi", "k_y")
    given = Hess2012(setting(own, speed=1.0), **dict(zip(keys, AT_5, strict=True)))
    usual = Hess2012(setting(benchmark))
    seen = sight(roll=0.1, deviation=0.5)
    assert given.intend(0.01, 0.0, seen) == usual.intend(0.01, 0.0, seen)


@pytest.mark.parametrize("speed", SPEEDS)
def test_outer_loops_cross_over_at_2_1_and_half_a_radian_per_second(
    benchmark: Bicycle, speed: float
):
    """[H12]: roll, heading, lateral position. Between published speeds too."""
    found = crossovers(benchmark, published_gains(benchmark, speed), speed)
    assert found[2:] == pytest.approx((2.0, 1.0, 0.5), rel=0.05)


@pytest.mark.parametrize("name", ["browser", "pista", "rigid-early", "rigid", "davis"])
def test_of_the_other_bicycles_too_at_5_m_s(name: str):
    bicycle = bicycles.load(name)
    found = crossovers(bicycle, published_gains(bicycle, 5.0), 5.0)
    assert found[2:] == pytest.approx((2.0, 1.0, 0.5), rel=0.03)


def test_crossovers_are_where_a_bode_diagram_has_them(benchmark: Bicycle):
    """By a sweep of the frequency, the loops closed one after the other."""
    speed, gains = 4.0, published_gains(benchmark, 4.0)
    passive = linear_hess(benchmark, Gains(0.0, 0.0, 0.0, 0.0, 0.0), speed)
    A = closed_loop(benchmark, speed, passive, law=None)
    B = np.zeros(8)
    B[7] = 900.0
    tilt, w = math.cos(benchmark.steer_axis_tilt), benchmark.wheelbase
    C = np.zeros((5, 8))
    C[0, 1] = C[1, 2] = C[2, 0] = C[3, 4] = C[4, 5] = 1.0
    C[4, 4], C[4, 1] = w, -benchmark.trail * tilt
    omega = np.geomspace(0.1, 100, 20_001)
    s = 1j * omega[:, None, None] * np.eye(8)
    found = crossovers(benchmark, gains, speed)
    for gain, row, crossover in zip(gains, C, found, strict=True):
        B = gain * B
        magnitude = abs(np.linalg.solve(s - A, B[:, None])[:, :, 0] @ row)
        falls = np.flatnonzero((magnitude[:-1] > 1) & (magnitude[1:] <= 1))
        expected = omega[falls] if len(falls) else [math.nan]
        assert crossover == pytest.approx(expected[0], rel=1e-3, nan_ok=True)
        A = A - np.outer(B, row)


@pytest.mark.parametrize("speed", SPEEDS)
def test_stable_on_the_bicycle_and_with_haptics_but_not_without(benchmark: Bicycle, speed: float):
    rider = linear_hess(benchmark, published_gains(benchmark, speed), speed)
    growth = {
        law: spectral_abscissa(closed_loop(benchmark, speed, rider, law=law))
        for law in (None, Law.PAPER, Law.MOMENTUM, Law.OFF)
    }
    assert max(growth[None], growth[Law.PAPER], growth[Law.MOMENTUM]) < -0.15
    assert growth[Law.OFF] > 3.0


# moorepants/BMD2016 (CC-BY), data/hqmbenchmark.csv: ω [rad/s] and HQM of the benchmark bicycle at
# 5 m/s, the peak among them.
PUBLISHED_HQM = (
    (0.01, 1.6133), (1.2218, 1.8346), (2.4336, 1.828), (4.8573, 1.3752), (9.7045, 1.6306),
    (12.128, 2.9438), (13.34, 4.6373), (14.552, 2.9272), (19.399, 0.4202), (40.0, 0.013106),
)  # fmt: skip


def test_handling_quality_is_as_published(benchmark: Bicycle):
    frequencies, published = np.array(PUBLISHED_HQM).T
    found = handling_quality(benchmark, AT_5, 5.0, frequencies)
    assert found == pytest.approx(published, rel=1e-3)


def test_a_slow_bicycle_handles_worse(benchmark: Bicycle):
    """[H12]: speed matters more than the bicycle."""
    frequencies = np.linspace(0.01, 40, 400)
    peaks = [
        handling_quality(benchmark, published_gains(benchmark, v), v, frequencies).max()
        for v in (3.2, 5.0, 8.0, 12.0)
    ]
    assert peaks == sorted(peaks, reverse=True)


def test_on_a_straight_line_he_is_his_linear_model(benchmark: Bicycle):
    """Of each signal alone: -Π k of the loops that it passes, T_δ at rest."""
    rider = Hess2012(setting(benchmark))
    tilt, w = math.cos(benchmark.steer_axis_tilt), benchmark.wheelbase
    k = np.cumprod(AT_5)
    front = -benchmark.trail * tilt
    assert rider.intend(0.1, 0.0, sight()) == pytest.approx(-0.1 * (k[0] + k[4] * front))
    assert rider.intend(0.0, 9.9, sight(roll_rate=0.1)) == pytest.approx(-0.1 * k[1])
    assert rider.intend(0.0, 0.0, sight(roll=0.1)) == pytest.approx(-0.1 * k[2])
    heading = rider.intend(0.0, 0.0, sight(heading=0.1, heading_error=0.1))
    assert heading == pytest.approx(-0.1 * (k[3] + k[4] * w))
    assert rider.intend(0.0, 0.0, sight(deviation=0.1)) == pytest.approx(-0.1 * k[4])


def test_the_path_comes_through_its_filter(benchmark: Bicycle):
    """The step response of 2.4² / (s + 2.4)² is 1 - (1 + 2.4 t) e^{-2.4 t}."""
    path = make_path(PathSettings(kind="lane-change", start=0.5, length=0.5, offset=0.01))
    rider = Hess2012(setting(benchmark, path=path))
    seen = sight(station=-30.0)  # the path in view is not there yet: it begins at zero
    assert rider.intend(0.0, 0.0, seen) == 0.0
    there = sight(station=-10.0)  # he sees from -10 + 1.02 to -10 + 1.02 + 13.75 m
    times = 1e-3 * np.arange(1000)
    torques = [rider.intend(0.0, 0.0, there) for _ in times]
    step = 1 - (1 + 2.4 * times) * np.exp(-2.4 * times)
    expected = path.lateral(4.0) * float(np.prod(AT_5)) * step
    assert np.abs(torques - expected).max() < 1e-12


@pytest.mark.parametrize(("shown", "looks"), [(math.inf, PREVIEW), (10.0, PREVIEW), (0.5, 0.5)])
def test_he_looks_ahead_as_far_as_the_display_shows(benchmark: Bicycle, shown: float, looks: float):
    path = make_path(PathSettings(kind="lane-change", start=50.0))

    def begins(station: float) -> bool:
        rider = Hess2012(setting(benchmark, path=path, preview=shown))
        torques = [rider.intend(0.0, 0.0, sight(station=station)) for _ in range(100)]
        return max(map(abs, torques)) > 1e-9

    in_view = 50.0 - benchmark.wheelbase - 5.0 * looks
    assert begins(in_view + 0.5)
    assert not begins(in_view - 0.01)


def test_gains_follow_the_speed(benchmark: Bicycle):
    rider, fast = Hess2012(setting(benchmark)), Hess2012(setting(benchmark, speed=8.0))
    rider.intend(0.0, 0.0, sight())
    seen = sight(speed=8.0, roll=0.1)
    assert rider.intend(0.01, 0.0, seen) == fast.intend(0.01, 0.0, seen)
    at_the_end = rider.intend(0.01, 0.0, sight(speed=12.0, roll=0.1))
    assert rider.intend(0.01, 0.0, sight(speed=20.0, roll=0.1)) == at_the_end


def test_riders_of_a_batch_give_what_each_gives_alone(benchmark: Bicycle):
    path = make_path(PathSettings(kind="slalom"))
    random = np.random.default_rng(5)
    speeds, k_delta = np.array([3.5, 5.0, 7.7]), np.array([math.nan, 40.0, math.nan])
    shown = np.array([math.inf, 1.0, 3.0])
    here = setting(benchmark, path=path, speed=speeds, preview=shown)
    batch = Hess2012(here, k_delta=k_delta)
    alone = [
        Hess2012(setting(benchmark, path=path, speed=v, preview=p), k_delta=k)
        for v, k, p in zip(speeds.tolist(), k_delta.tolist(), shown.tolist(), strict=True)
    ]
    for tick in range(60):
        seen = Sight(*random.normal(size=(8, 3)))._replace(
            time=0.01 * tick, speed=speeds, station=random.uniform(0, 120, 3)
        )
        for _ in range(2):
            steer = random.normal(size=3)
            together = batch.intend(steer, steer, seen)
            each = [
                rider.intend(
                    float(steer[i]),
                    float(steer[i]),
                    Sight(*(float(x[i]) if np.ndim(x) else x for x in seen)),
                )
                for i, rider in enumerate(alone)
            ]
            assert together.tolist() == each


LANE_CHANGE = PathSettings(kind="lane-change")  # of 2 m, within 20 m
COLUMNS = [channel.name for channel in TICK_CHANNELS]


def lane_change(**changed: Any) -> tuple[Ending, dict[str, np.ndarray]]:
    rows: list[tuple[float, ...]] = []

    class Rows:
        append = staticmethod(rows.append)

    scenario = Scenario(
        speed=5.0, rider=RiderSettings(name="hess2012"), path=LANE_CHANGE, duration=13.0, **changed
    )
    ending = ride_parts(build(scenario), Rows())
    return ending, dict(zip(COLUMNS, np.array(rows).T, strict=False))


def test_a_lane_change_is_ridden_within_a_decimetre():
    ending, ridden = lane_change()
    assert ending.reason == "end of run"
    path = make_path(LANE_CHANGE)
    deviation = path.place(ridden["x"], ridden["y"], np.clip(ridden["x"], 0, None)).deviation
    assert math.sqrt(np.mean(deviation**2)) <= 0.1
    assert ridden["y"][-1] == pytest.approx(2.0, abs=0.02)


def test_without_haptics_he_falls():
    assert lane_change(law="off")[0].fell


def test_a_lane_change_is_that_of_the_published_model(benchmark: Bicycle):
    """The model, linear and continuous, on the bicycle by scipy; ours with the exact law."""
    _, ridden = lane_change(law="momentum", start=StartSettings(roll_deg=2.0))
    path, time = make_path(LANE_CHANGE), ridden["time"]
    A = np.zeros((10, 10))
    A[:8, :8] = closed_loop(benchmark, 5.0, linear_hess(benchmark, AT_5, 5.0), law=None)
    A[7, 8] = 900 * float(np.prod(AT_5))
    A[8, 9], A[9, 8], A[9, 9] = 1.0, -(2.4**2), -2 * 2.4
    B = np.zeros((10, 1))
    B[9] = 2.4**2
    ahead = path.lateral(5.0 * (time + PREVIEW) + benchmark.wheelbase)
    begin = np.zeros(10)
    begin[0] = math.radians(2.0)
    states = signal.lsim((A, B, np.eye(10), np.zeros((10, 1))), ahead, time, begin)[1]
    assert np.abs(ridden["y"] - states[:, 5]).max() < 0.03  # of headings up to 0.2 rad
    assert np.abs(ridden["roll"] - states[:, 0]).max() < math.radians(0.2)
