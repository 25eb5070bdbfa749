"""The optimal path follower against optima found another way, and on the paths themselves."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import Scenario
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.simulator import simulator_matrices
from bikesim.path.building import make_path
from bikesim.path.path import straight_path
from bikesim.path.settings import PathSettings
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import Ending
from bikesim.rider.base import Setting, Sight
from bikesim.rider.lqr import Lqr
from bikesim.rider.lqr_design import Figures, Plant, design, plant, steady_turn

USUAL = Figures(1.0, 1.0, 1.0, 3.0, 30.0, 0.707, 0.0, 0.0, 0.0)
INERTIA = 0.231


@pytest.fixture(scope="module")
def benchmark() -> Bicycle:
    return bicycles.load("benchmark")


def setting(bicycle: Bicycle, **changed: Any) -> Setting:
    usual = {
        "law": Law.PAPER, "inertia": INERTIA, "speed": 5.0, "step": 1e-3, "path": straight_path(),
    }  # fmt: skip
    return Setting(bicycle, **{**usual, **changed})


@pytest.mark.parametrize("law", list(Law))
@pytest.mark.parametrize("speed", [1.0, 3.5, 5.0, 9.0])
def test_the_loop_has_the_stable_roots_of_the_hamiltonian(
    benchmark: Bicycle, law: Law, speed: float
):
    """The optimum's closed loop: the stable half of [[A, -B Bᵀ/r], [-Q, -Aᵀ]]."""
    here = setting(benchmark, law=law)
    A, B, _ = plant(here, speed, USUAL)
    gains = design(here, speed, USUAL).gains
    roots = np.linalg.eigvals(A - np.outer(B, gains))
    hamiltonian = np.block([[A, -np.outer(B, B)], [-np.diag([1.0, 1.0, *[0.0] * 6]), -A.T]])
    both = np.linalg.eigvals(hamiltonian)
    stable = both[both.real < 0]
    assert len(stable) == 8
    assert roots.real.max() < -0.25
    for root in stable:
        assert np.abs(roots - root).min() < 1e-5 * max(1.0, abs(root))


def test_a_steady_turn_is_that_of_the_geometry_and_of_the_roll_equation(benchmark: Bicycle):
    """δ = κ w / cos λ; φ balances it; the torque holds what is left of the steer equation."""
    X, U = steady_turn(plant(setting(benchmark), 5.0, USUAL))
    delta = benchmark.wheelbase / math.cos(benchmark.steer_axis_tilt)
    _, _, K = simulator_matrices(benchmark, Law.PAPER, 5.0, INERTIA)
    phi = -K[0, 1] * delta / K[0, 0]
    torque = K[1, 0] * phi + K[1, 1] * delta
    assert pytest.approx([0, 0, phi, delta, 0, 0, torque, 0], abs=1e-9) == X
    assert pytest.approx(torque) == U
    assert phi == pytest.approx(5.0**2 / 9.81, rel=0.1)  # tan φ ≈ v² κ / g


def test_arms_are_part_of_what_he_steers(benchmark: Bicycle):
    """In a turn they pull back by their stiffness times the steer."""
    free = steady_turn(plant(setting(benchmark), 5.0, USUAL))
    held = steady_turn(plant(setting(benchmark), 5.0, USUAL._replace(arm_stiffness=5.0)))
    assert held[1] - free[1] == pytest.approx(5.0 * free[0][3])


def least_squares(
    system: Plant, turn: float, begin: np.ndarray, curvature: np.ndarray, step: float
) -> np.ndarray:
    """The torques, each held for a step, that make the sum of e² + ε² + (u - U κ)² least."""
    n, count = len(system.B), len(curvature)
    inputs = np.column_stack([system.B, system.D])
    stepped = expm(step * np.block([[system.A, inputs], [np.zeros((2, n + 2))]]))
    A, B, D = stepped[:n, :n], stepped[:n, n], stepped[:n, n + 1]
    free, forced = begin, np.zeros((n, count))
    rows, wanted = [np.eye(count)], [turn * curvature]
    for k in range(count):
        free, forced = A @ free + D * curvature[k], A @ forced
        forced[:, k] += B
        rows.append(forced[:2].copy())
        wanted.append(-free[:2])
    G, w = np.vstack(rows), np.concatenate(wanted)
    return np.linalg.solve(G.T @ G, G.T @ w)


@pytest.mark.parametrize("muscle_frequency", [0.0, 30.0])
def test_the_first_torque_is_that_of_the_whole_problem_solved_at_once(
    benchmark: Bicycle, muscle_frequency: float
):
    """The path turns 4 m ahead, over 6 m. With the curve alone, and leaning beside a straight."""
    path = make_path(PathSettings(kind="circle", start=4.0, entry=6.0, radius=20.0))
    figures = USUAL._replace(preview_time=20.0, muscle_frequency=muscle_frequency)
    here, speed, step = setting(benchmark, path=path), 5.0, 0.01
    system = plant(here, speed, figures)
    _, turn = steady_turn(system)
    curvature = path.curvature(speed * step * (np.arange(700) + 0.5))

    upright = np.zeros(len(system.B))
    expected = least_squares(system, turn, upright, curvature, step)[0]
    seen = Sight(0.0, speed, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert Lqr(here, **figures._asdict()).intend(0.0, 0.0, seen) == pytest.approx(
        expected, rel=0.02
    )
    assert abs(expected) > 0.02

    leaning = upright.copy()
    leaning[[0, 1, 2]] = 0.1, -0.02, 0.03
    expected = least_squares(system, turn, leaning, 0 * curvature, step)[0]
    seen = seen._replace(deviation=0.1, heading=-0.02, heading_error=-0.02, roll=0.03)
    straight = Lqr(setting(benchmark), **figures._asdict())
    assert straight.intend(0.0, 0.0, seen) == pytest.approx(expected, rel=0.02)


COLUMNS = [channel.name for channel in TICK_CHANNELS]


def ridden(path: dict[str, Any] | str, **changed: Any) -> tuple[Ending, np.ndarray]:
    """How it ended, and the deviation of the rear contact at each tick [m]."""
    rows: list[tuple[float, ...]] = []

    class Rows:
        append = staticmethod(rows.append)

    usual = {"rider": "lqr", "speed": 5.0, "period": 0.005, "physics_step": 0.001}
    scenario = Scenario(**{**usual, "path": path, **changed})
    ending = ride_parts(build(scenario), Rows())
    line, near, deviation = make_path(scenario.path), 0.0, []
    for row in rows:
        place = line.place(row[COLUMNS.index("x")], row[COLUMNS.index("y")], near)
        near = place.station
        deviation.append(place.deviation)
    return ending, np.array(deviation)


@pytest.mark.parametrize(
    ("path", "duration", "most"),
    [
        ("lane-change", 13.0, 0.1),
        ("double-lane-change", 14.0, 0.25),
        ("slalom", 26.0, 0.2),
        ("circle", 34.0, 0.06),
        ("figure-eight", 40.0, 0.1),
    ],
)
def test_he_stays_on_the_path(path: str, duration: float, most: float):
    ending, deviation = ridden(path, duration=duration)
    assert ending.reason == "end of run"
    assert np.abs(deviation).max() < most


@pytest.mark.parametrize("law", ["paper", "momentum", "off"])
def test_on_a_circle_no_error_is_left(law: str):
    _, deviation = ridden("circle", duration=22.0, law=law)
    assert np.abs(deviation[-400:]).max() < 0.002  # the last 2 s


def test_from_a_lean_he_comes_back_to_the_line():
    ending, deviation = ridden("straight", duration=12.0, start={"roll_deg": 5.0})
    assert ending.reason == "end of run"
    assert np.abs(deviation).max() > 0.3
    assert abs(deviation[-1]) < 0.01


def test_he_follows_while_the_speed_changes():
    ending, deviation = ridden(
        {"kind": "circle", "radius": 20.0}, duration=25.0, speed_profile=[[5, 3.5], [15, 6.5]]
    )
    assert ending.reason == "end of run"
    assert np.abs(deviation).max() < 0.5
    assert abs(deviation[-1]) < 0.01


def test_a_preview_that_is_not_shown_is_not_used(benchmark: Bicycle):
    path = make_path(PathSettings(kind="lane-change", start=20.0))
    seen = Sight(0.0, 5.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0)  # 2 s before the path turns
    for shown, wants, sees in ((math.inf, 3.0, True), (1.9, 3.0, False), (math.inf, 1.9, False)):
        rider = Lqr(setting(benchmark, path=path, preview=shown), preview_time=wants)
        assert bool(rider.intend(0.0, 0.0, seen)) is sees


def test_gains_follow_the_speed(benchmark: Bicycle):
    path = make_path(PathSettings(kind="slalom"))
    rider = Lqr(setting(benchmark, path=path))
    fast = Lqr(setting(benchmark, path=path, speed=7.0))
    seen = Sight(0.0, 7.03, 0.1, 0.1, 0.0, 40.0, 0.2, 0.1)
    assert rider.intend(0.1, 0.1, seen) == fast.intend(0.1, 0.1, seen)
    near = fast.intend(0.1, 0.1, seen._replace(speed=6.96))
    assert near == fast.intend(0.1, 0.1, seen)


def test_riders_of_a_batch_give_what_each_gives_alone(benchmark: Bicycle):
    path = make_path(PathSettings(kind="figure-eight"))
    random = np.random.default_rng(5)
    speeds = np.array([3.5, 5.0, 5.0, 0.6])
    figures = {
        "lateral_weight": np.array([1.0, 3.0, 1.0, 1.0]),
        "preview_time": np.array([3.0, 3.0, 0.5, 2.0]),
        "muscle_frequency": np.array([30.0, 30.0, 0.0, 10.0]),
        "arm_damping": 2.0,
    }
    batch = Lqr(setting(benchmark, path=path, speed=speeds), **figures)
    alone = [
        Lqr(
            setting(benchmark, path=path, speed=v),
            **{k: float(np.broadcast_to(f, 4)[i]) for k, f in figures.items()},
        )
        for i, v in enumerate(speeds.tolist())
    ]
    for tick in range(40):
        seen = Sight(*random.normal(size=(8, 4)))._replace(
            time=0.01 * tick, speed=speeds + 0.02 * tick, station=random.uniform(-5, 400, 4)
        )
        for _ in range(2):
            steer = random.normal(size=4)
            together = batch.intend(steer, -steer, seen)
            each = [
                rider.intend(
                    float(steer[i]),
                    -float(steer[i]),
                    Sight(*(float(x[i]) if np.ndim(x) else x for x in seen)),
                )
                for i, rider in enumerate(alone)
            ]
            assert together.tolist() == each


@pytest.mark.parametrize("speed", [0.0, 0.49])
def test_to_start_too_slowly_is_refused(benchmark: Bicycle, speed: float):
    with pytest.raises(InputError, match=rf"speed = {speed:g} m/s: must be at least 0\.5 m/s"):
        Lqr(setting(benchmark, speed=speed))


@pytest.mark.parametrize("heading_weight", [0.0, 1.0])
def test_a_rider_who_does_not_care_where_he_rides_is_refused(
    benchmark: Bicycle, heading_weight: float
):
    with pytest.raises(InputError, match="no gains at 5 m/s for lateral_weight = 0, heading_"):
        Lqr(setting(benchmark), lateral_weight=0.0, heading_weight=heading_weight)
