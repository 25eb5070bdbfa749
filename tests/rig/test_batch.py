"""A rig in a batch does what it does alone, bit for bit."""

from collections.abc import Sequence

import mujoco
import numpy as np
import pytest

from bikesim.model.haptic import BicycleState
from bikesim.model.real import Real
from bikesim.rider.base import Arms
from bikesim.rig.batch import BatchRig, Riding
from bikesim.rig.mjcf import rig_model
from bikesim.rig.settings import RigSettings, rig_names
from bikesim.rig.virtual import VirtualRig

RIGS, TICKS = 5, 400
TORQUES = np.linspace(-3.0, 4.0, RIGS)  # hard enough for some bars to reach their stop
ARMS = [Arms(0.1 * k, 0.5 * k, 2.0 * k) for k in range(RIGS)]


class Springy:
    """Pulls to and fro, and holds back by what he feels; takes other arms half-way."""

    def __init__(self, pull: Real, arms: Arms, later: Arms) -> None:
        self._pull, self.arms, self._later = pull, arms, later
        self._asked = 0

    def torque(self, steer: Real, steer_rate: Real, seen: BicycleState) -> Real:
        self._asked += 1
        if self._asked == TICKS:
            self.arms = self._later
        return self._pull * (1.0 if self._asked % 300 < 200 else -1.0) - 0.3 * steer_rate


def stacked(arms: Sequence[Arms]) -> Arms:
    return Arms(*(np.array(values) for values in zip(*arms, strict=True)))


def figures(period: float, step: float) -> dict:
    return {
        "name": "a rig",
        "inertia": 0.25,
        "steer_axis_tilt": 0.3,
        "period": period,
        "step": step,
    }


def rows(rig: VirtualRig | BatchRig, seen: BicycleState) -> list[np.ndarray]:
    out = []
    for k in range(TICKS):
        sample = rig.read()
        sent = rig.command(0.8 * np.sin(0.05 * k) - 0.5 * sample.steer_rate)
        rig.show(seen)
        out.append([np.array(v) for v in (*sample[1:], sent, *rig.telemetry())])
        rig.wait()
    assert rig.read().time == pytest.approx(TICKS * rig.info.period)
    return out


@pytest.mark.parametrize(("period", "step"), [(1e-3, 5e-4), (5e-3, 1e-3)])
@pytest.mark.parametrize("name", rig_names())
def test_each_rig_does_what_it_does_alone(
    name: str, period: float, step: float, upright: BicycleState
):
    settings = RigSettings(name=name, angle_noise=1e-4, coulomb_friction=0.02)
    batch = BatchRig(
        settings,
        Springy(TORQUES, stacked(ARMS), stacked(ARMS[::-1])),
        Riding(RIGS),
        randoms=[np.random.default_rng(k) for k in range(RIGS)],
        steer=np.linspace(-0.2, 0.2, RIGS),
        **figures(period, step),
    )
    together = rows(batch, upright)
    for k in range(RIGS):
        alone = VirtualRig(
            settings,
            Springy(float(TORQUES[k]), ARMS[k], ARMS[::-1][k]),
            random=np.random.default_rng(k),
            steer=float(np.linspace(-0.2, 0.2, RIGS)[k]),
            **figures(period, step),
        )
        for one, many in zip(rows(alone, upright), together, strict=True):
            np.testing.assert_array_equal(one, [np.broadcast_to(v, RIGS)[k] for v in many])


def test_one_that_stopped_is_not_stepped_and_says_zero(upright: BicycleState):
    riding = Riding(3)
    rig = BatchRig(
        RigSettings(),
        Springy(np.ones(3), Arms(), Arms()),
        riding,
        randoms=[np.random.default_rng(k) for k in range(3)],
        **figures(1e-3, 5e-4),
    )
    rig.show(upright)
    for _ in range(100):
        rig.wait()
    riding.stop(np.array([False, True, False]))
    before = rig.telemetry()[2].copy()
    for _ in range(100):
        rig.wait()
    moved = rig.telemetry()[2] != before
    assert moved.tolist() == [True, False, True]
    assert rig.read().steer[1] == rig.read().steer_rate[1] == 0.0
    assert (riding.count, riding.ids is not None and riding.ids.tolist()) == (2, [0, 2])


def test_it_closes_at_zero_torque(upright: BicycleState):
    rig = BatchRig(
        RigSettings(),
        Springy(np.ones(2), Arms(), Arms()),
        Riding(2),
        randoms=[np.random.default_rng(k) for k in range(2)],
        **figures(1e-3, 5e-4),
    )
    rig.command(np.array([1.0, 2.0]))
    rig.close()
    assert rig.batch.ctrl[:, 0].tolist() == [0.0, 0.0]


def test_the_undrawn_model_has_no_drawing_and_the_same_mechanism():
    makes = {"inertia": 0.25, "arms": Arms(0.1, 1, 2), "steer_axis_tilt": 0.3, "step": 5e-4}
    drawn = rig_model(RigSettings(), **makes, drawn=True)
    bare = rig_model(RigSettings(), **makes)
    assert (bare.ngeom, bare.ncam, bare.nlight, bare.ntex) == (0, 0, 0, 0)
    assert drawn.ngeom > 10
    for model in (drawn, bare):
        data = mujoco.MjData(model)
        data.qpos[0] = 0.3
        mujoco.mj_step(model, data, 100)
        assert data.qpos[0] == pytest.approx(0.29, abs=0.01)
    np.testing.assert_array_equal(drawn.dof_invweight0, bare.dof_invweight0)
