import numpy as np
import pytest

from bikesim.rig.virtual import VirtualRig

from .conftest import INERTIA, MakeRig, Pull, true_rate, wait


def motion_of(rig: VirtualRig, torque: float) -> list[tuple[float, float]]:
    """Motor torque and steer rate at each tick after a command."""
    rig.command(torque)
    out = []
    for _ in range(200):
        rig.wait()
        out.append(rig.telemetry()[1::2])
    return out


@pytest.mark.parametrize("milliseconds", [1, 4, 9])
def test_its_delay_is_as_asked(make_rig: MakeRig, milliseconds: int):
    motion = motion_of(make_rig(motor_delay=milliseconds * 1e-3), 0.5)
    lost = 0.2 - motion[-1][1] * INERTIA / 0.5
    assert lost == pytest.approx(milliseconds * 1e-3, abs=1e-9)


def test_its_lag_is_a_first_order_one(make_rig: MakeRig):
    motion = motion_of(make_rig(motor_lag=0.02), 0.5)
    times = 1e-3 * np.arange(1, 201)
    torques = np.array([torque for torque, _ in motion])
    # The torque told is that of the last physics step, which began half a millisecond ago.
    assert torques == pytest.approx(0.5 * (1 - np.exp(-(times - 5e-4) / 0.02)), abs=1e-9)


def test_its_limit_holds_and_is_told(make_rig: MakeRig):
    rig = make_rig(torque_limit=0.4)
    assert rig.command(-7.0) == -0.4
    wait(rig, 500)
    assert true_rate(rig) == pytest.approx(-0.4 / INERTIA * 0.5, rel=1e-12)


def test_its_limit_holds_behind_the_lag(make_rig: MakeRig):
    motion = motion_of(make_rig(torque_limit=0.4, motor_lag=0.01), 7.0)
    assert max(torque for torque, _ in motion) <= 0.4


def test_its_limit_does_not_bind_the_rider(make_rig: MakeRig):
    rig = make_rig(rider=Pull(0.5), torque_limit=0.1)
    wait(rig, 500)
    assert true_rate(rig) == pytest.approx(0.5 / INERTIA * 0.5, rel=1e-12)


@pytest.mark.parametrize("torque", [0.26, -0.26, 0.04])
def test_it_takes_whole_counts(make_rig: MakeRig, torque: float):
    sent = make_rig(torque_resolution=0.1).command(torque)
    assert sent == pytest.approx(round(torque / 0.1) * 0.1)


def test_a_count_does_not_pass_the_limit(make_rig: MakeRig):
    assert make_rig(torque_resolution=0.3, torque_limit=0.4).command(0.4) <= 0.4


def test_closed_it_is_at_zero(make_rig: MakeRig):
    rig = make_rig()
    rig.command(1.0)
    rig.close()
    rig.wait()
    assert rig.telemetry()[1] == 0.0
    assert true_rate(rig) == 0.0
