import math

import mujoco
import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.rider.base import Arms
from bikesim.rig.virtual import VirtualRig

from .conftest import INERTIA, MakeRig, true_rate, true_steer, turn, wait


def total_inertia(rig: VirtualRig) -> float:
    """About the steer axis, arms and rotor too: MuJoCo's own mass matrix."""
    full = np.zeros((1, 1))
    mujoco.mj_fullM(rig.model, rig.data, full)
    return full.item()


class TestInertia:
    @pytest.mark.parametrize("inertia", [0.0427, 0.2310850117, 0.23127589, 3.0])
    @pytest.mark.parametrize("rotor", [0.0, 0.03])
    def test_is_exactly_what_was_asked(self, make_rig: MakeRig, inertia: float, rotor: float):
        rig = make_rig(inertia=inertia, rotor_inertia=rotor)
        assert total_inertia(rig) == pytest.approx(inertia, rel=1e-15)

    @pytest.mark.parametrize("rotor", [0.0, 0.03])
    def test_arms_come_on_top(self, make_rig: MakeRig, rotor: float):
        rig = make_rig(arms=Arms(inertia=0.1), rotor_inertia=rotor)
        assert total_inertia(rig) == pytest.approx(INERTIA + 0.1, rel=1e-15)

    @pytest.mark.parametrize("angle", [-0.9, 0.0, 0.5])
    def test_is_the_same_at_every_angle(self, make_rig: MakeRig, angle: float):
        rig = make_rig()
        turn(rig, angle=angle)
        wait(rig, 1)
        assert total_inertia(rig) == pytest.approx(INERTIA, rel=1e-14)

    def test_told_is_that_without_arms(self, make_rig: MakeRig):
        assert make_rig(arms=Arms(inertia=0.1)).info.inertia == INERTIA

    def test_below_that_of_the_rotor_is_refused(self, make_rig: MakeRig):
        with pytest.raises(InputError, match=r"rotor_inertia = 0\.25 .* below the whole inertia"):
            make_rig(rotor_inertia=INERTIA)


class TestBar:
    def test_left_alone_keeps_its_speed(self, make_rig: MakeRig):
        rig = make_rig()
        turn(rig, rate=0.5)
        wait(rig, 1000)
        assert true_rate(rig) == pytest.approx(0.5, rel=1e-12)
        assert true_steer(rig) == pytest.approx(0.5, rel=1e-12)

    @pytest.mark.parametrize("angle", [-0.8, 0.3])
    def test_is_balanced(self, make_rig: MakeRig, angle: float):
        rig = make_rig()
        turn(rig, angle=angle)
        wait(rig, 2000)
        assert true_steer(rig) == pytest.approx(angle, abs=1e-12)

    @pytest.mark.parametrize("torque", [0.5, -0.2])
    def test_a_torque_accelerates_it(self, make_rig: MakeRig, torque: float):
        rig = make_rig()
        assert rig.command(torque) == torque
        wait(rig, 500)
        assert true_rate(rig) == pytest.approx(torque / INERTIA * 0.5, rel=1e-12)
        assert true_steer(rig) == pytest.approx(torque / INERTIA * 0.5**2 / 2, rel=2e-3)

    @pytest.mark.parametrize("sign", [1, -1])
    def test_the_mechanical_stop_holds_it(self, make_rig: MakeRig, sign: int):
        rig = make_rig(steer_stop_deg=40.0)
        rig.command(3.0 * sign)
        reached = []
        for _ in range(2000):
            rig.wait()
            reached.append(math.degrees(sign * true_steer(rig)))
        assert 39 < max(reached) < 41
        assert reached[-1] == pytest.approx(40, abs=0.1)

    def test_told_its_stop_is_in_radians(self, make_rig: MakeRig):
        assert make_rig(steer_stop_deg=40.0).info.steer_stop == pytest.approx(math.radians(40))

    def test_arms_are_a_spring_and_damper(self, make_rig: MakeRig):
        """J δ̈ + b δ̇ + k δ = 0 from rest at 0.2 rad."""
        J, b, k = INERTIA + 0.1, 0.4, 20.0
        rig = make_rig(arms=Arms(0.1, b, k), step=1e-4)
        turn(rig, angle=0.2)
        wait(rig, 700)
        decay, omega = b / 2 / J, math.sqrt(k / J - (b / 2 / J) ** 2)
        expected = (
            0.2
            * math.exp(-decay * 0.7)
            * (math.cos(omega * 0.7) + decay / omega * math.sin(omega * 0.7))
        )
        assert true_steer(rig) == pytest.approx(expected, abs=2e-4)

    def test_viscous_friction_slows_it(self, make_rig: MakeRig):
        rig = make_rig(viscous_friction=0.5)
        turn(rig, rate=1.0)
        wait(rig, 500)
        assert true_rate(rig) == pytest.approx(math.exp(-0.5 / INERTIA * 0.5), rel=2e-3)

    def test_coulomb_friction_holds_against_a_small_torque(self, make_rig: MakeRig):
        rig = make_rig(coulomb_friction=0.5)
        rig.command(0.3)
        wait(rig, 1000)
        # Without it: 0.6 rad. MuJoCo's friction is a stiff damper, which creeps.
        assert abs(true_steer(rig)) < 2e-3

    def test_coulomb_friction_takes_its_part_of_a_large_torque(self, make_rig: MakeRig):
        rig = make_rig(coulomb_friction=0.5)
        rig.command(0.8)
        wait(rig, 500)
        assert true_rate(rig) == pytest.approx(0.3 / INERTIA * 0.5, rel=1e-2)

    def test_the_steer_axis_is_the_bicycles(self, make_rig: MakeRig):
        rig = make_rig()
        axis = rig.data.joint("steer").xaxis  # down, as a positive steer is to the right
        assert axis == pytest.approx([math.sin(0.3), 0, -math.cos(0.3)], abs=1e-12)

    def test_a_positive_steer_turns_it_to_the_right(self, make_rig: MakeRig):
        """World: x forward, y left."""
        rig = make_rig()
        turn(rig, angle=0.3)
        wait(rig, 1)
        assert rig.data.site("grip_right").xpos[0] < rig.data.site("grip_left").xpos[0]


class TestBrokenPhysics:
    @pytest.mark.parametrize("step", [0.005, 0.01])
    def test_a_step_too_long_for_the_arms_is_refused(self, make_rig: MakeRig, step: float):
        with pytest.raises(InputError, match=f"physics_step = {step} s: must be at most"):
            make_rig(arms=Arms(stiffness=5000.0), step=step, period=step)

    def test_the_longest_step_allowed_is_stable_and_near_the_truth(self, make_rig: MakeRig):
        omega = 0.4999 / 0.01
        rig = make_rig(arms=Arms(stiffness=omega**2 * INERTIA), step=0.01, period=0.01)
        turn(rig, angle=0.1)
        steer = []
        for _ in range(1000):
            rig.wait()
            steer.append(true_steer(rig))
        crossings = np.count_nonzero(np.diff(np.sign(steer)))
        assert max(np.abs(steer)) < 0.11
        assert crossings == pytest.approx(10 * omega / math.pi, rel=0.02)

    @pytest.mark.filterwarnings("ignore")
    def test_a_state_that_is_not_finite_is_read_as_such(
        self, make_rig: MakeRig, monkeypatch, tmp_path
    ):
        """MuJoCo would by itself begin again at rest; its log lands in the working folder."""
        monkeypatch.chdir(tmp_path)
        rig = make_rig()
        turn(rig, rate=math.nan)
        wait(rig, 2)
        assert math.isnan(rig.read().steer)


class TestTime:
    @pytest.mark.parametrize("period", [1e-3, 5e-3, 20e-3])
    def test_a_tick_is_a_period_of_physics(self, make_rig: MakeRig, period: float):
        rig = make_rig(period=period)
        wait(rig, 7)
        assert rig.data.time == pytest.approx(7 * period)
        assert rig.read().time == 7 * period

    @pytest.mark.parametrize(("period", "step"), [(1e-3, 3e-4), (1e-3, 2e-3), (1e-3, 7e-4)])
    def test_a_period_is_a_whole_number_of_steps(
        self, make_rig: MakeRig, period: float, step: float
    ):
        with pytest.raises(InputError, match=f"physics_step = {step} s: .*period"):
            make_rig(period=period, step=step)

    def test_the_first_sample_is_of_the_bar_at_rest(self, make_rig: MakeRig):
        assert make_rig().read() == (0, 0, 0)
