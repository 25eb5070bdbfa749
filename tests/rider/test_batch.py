"""A rider of a batch does to the bit what he does alone, whatever is human about him."""

import math
from typing import Any

import numpy as np
import pytest

from bikesim.path.building import make_path
from bikesim.path.settings import PathSettings
from bikesim.rider.building import make_rider
from bikesim.rider.settings import RiderSettings
from bikesim.rider.vision import VisionSettings

from .conftest import STEP

RIDERS, STEPS = 4, 1600
HUMAN: list[dict[str, Any]] = [
    {"visual_delay": 0.05 * k, "roll_gain": 0.3 + 0.1 * k} for k in range(RIDERS)
]
DIFFERENT: dict[str, tuple[str, list[dict[str, Any]], list[dict[str, Any]]]] = {
    "nothing": ("human", [{}] * RIDERS, [{}] * RIDERS),
    "figures": ("human", HUMAN, [{}] * RIDERS),
    "noise": (
        "human",
        [
            {
                "visual_roll_noise": 0.01 * k,
                "visual_heading_noise": 0.02,
                "vestibular_share": 0.3 * k,
                "vestibular_noise": 0.1 * (3 - k),
                "vestibular_delay": 0.01,
                "remnant_rms": 0.1 * (k % 2),
                "remnant_bandwidth": 5.0 + k,
            }
            for k in range(RIDERS)
        ],
        [{}] * RIDERS,
    ),
    "hands": (
        "schwab2013-184",
        [
            {
                "proprioceptive_delay": 0.02 * k,
                "proprioceptive_steer_noise": 0.001 * k,
                "torque_limit": 1.0 + k,
                "muscle_frequency": 10.0 + 5 * (k // 2),
            }
            for k in range(RIDERS)
        ],
        [{}] * RIDERS,
    ),
    "grips": (
        "human",
        [
            {"grips": grips, "arm_damping": 1.0 + k}
            for k, grips in enumerate(
                (
                    [],
                    [[0.2, "hands-off"], [0.4, "normal"]],
                    [[0.3, "tight"]],
                    [[0.2, "hands-off"], [0.5, "tight"]],
                )
            )
        ],
        [{}] * RIDERS,
    ),
    "vision": (
        "hess2012",
        [{}] * RIDERS,
        [
            {},
            {"roll_cue": False, "preview": 1.0},
            {"delay": 0.1},
            {"occlusions": [[0.2, 0.5]], "delay": 0.03, "preview": 0.5},
        ],
    ),
    "optimal": ("lqr", [{"effort_weight": 1.0 + k} for k in range(RIDERS)], [{}] * RIDERS),
}


def signals(k: int, i: int) -> dict[str, float]:
    t = k * STEP
    return {
        "roll": 0.1 * math.sin(1.3 * t + 0.2 * i),
        "roll_rate": 0.2 * math.cos(1.7 * t + 0.1 * i),
        "heading": 0.05 * math.sin(2.0 * t) + 0.01 * i,
        "x": 5.0 * t,
        "y": 0.2 * math.sin(0.8 * t + i),
    }


@pytest.mark.parametrize("what", DIFFERENT)
def test_each_gives_what_he_gives_alone(setting, make_many, seen, what: str):
    name, figures, shown = DIFFERENT[what]
    where = {"path": make_path(PathSettings(kind="lane-change", start=1.0)), "speed": 5.0}
    settings = [RiderSettings(name=name, **one) for one in figures]
    visions = [VisionSettings(**one) for one in shown]
    many = make_many(settings, visions, **where)
    alone = [
        make_rider(one, setting(**where), vision, np.random.default_rng(k))
        for k, (one, vision) in enumerate(zip(settings, visions, strict=True))
    ]
    bicycles, batch = [], seen()
    for k in range(STEPS):
        steer = np.array([0.1 * math.sin(3e-3 * k + i) for i in range(RIDERS)])
        if k % 2 == 0:
            each = [signals(k, i) for i in range(RIDERS)]
            at = {"time": k * STEP, "speed": 5.0}
            bicycles = [seen(**one, **at) for one in each]
            arrays = {key: np.array([one[key] for one in each]) for key in each[0]}
            batch = seen(**arrays, **at)
        torques = many.torque(steer.copy(), 2 * steer, batch)
        assert torques.shape == (RIDERS,)
        expected = [
            one.torque(angle, 2 * angle, bicycle)
            for one, angle, bicycle in zip(alone, steer.tolist(), bicycles, strict=True)
        ]
        assert torques.tolist() == expected, k
    arms = [np.broadcast_to(figure, RIDERS).tolist() for figure in many.arms]
    assert list(zip(*arms, strict=True)) == [tuple(one.arms) for one in alone]


def test_nothing_of_a_rider_is_random_but_his_seed(make_many, seen):
    """Beside others or not, at any place in the batch."""
    human = RiderSettings(name="human")
    torques = [
        make_many([human] * count).torque(np.zeros(count), np.zeros(count), seen(np.zeros(count)))
        for count in (3, 5)
    ]
    assert torques[0].tolist() == torques[1][:3].tolist()
