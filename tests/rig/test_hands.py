"""A rider's hands on the bar of the virtual rig."""

import pytest

from bikesim.model.haptic import BicycleState

from .conftest import INERTIA, MakeRig, Pull, true_rate, wait


@pytest.mark.parametrize(
    ("period", "step", "times"), [(1e-3, 5e-4, 2), (0.02, 5e-4, 40), (1e-3, 1e-3, 1)]
)
def test_they_act_at_every_step_of_the_physics(
    make_rig: MakeRig, period: float, step: float, times: int
):
    rider = Pull(0.0)
    make_rig(rider=rider, period=period, step=step).wait()
    assert len(rider.asked) == times


def test_they_turn_the_bar_with_their_torque(make_rig: MakeRig):
    rig = make_rig(rider=Pull(0.5))
    wait(rig, 500)
    assert true_rate(rig) == pytest.approx(0.5 / INERTIA * 0.5, rel=1e-12)
    assert rig.telemetry()[:2] == (0.5, 0.0)


def test_they_feel_the_bar_as_it_is_now(make_rig: MakeRig):
    rider = Pull(0.5)
    make_rig(rider=rider).wait()
    assert rider.asked[1][1] == pytest.approx(0.5 / INERTIA * 5e-4)


def test_the_rider_sees_what_was_shown_last(make_rig: MakeRig, upright: BicycleState):
    rider = Pull(0.0)
    rig = make_rig(rider=rider)
    leaning = upright._replace(roll=0.2)
    for shown in (upright, leaning):
        rig.show(shown)
        rig.wait()
    assert [seen for _, _, seen in rider.asked] == [upright, upright, leaning, leaning]
