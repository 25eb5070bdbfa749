"""The estimator on bars whose figures are known: one of its own kind, and MuJoCo's."""

from typing import Any

import numpy as np
import pytest

from bikesim.bench.identify import identify_bar
from bikesim.bench.identify_excitation import MOST_TORQUE, Excitation, excite
from bikesim.bench.identify_model import BarRecord
from bikesim.errors import InputError
from bikesim.guard import Stop, Verdict
from bikesim.model.haptic import BicycleState
from bikesim.rider.base import Arms
from bikesim.rig.base import Sample
from bikesim.rig.settings import RigSettings
from bikesim.rig.virtual import VirtualRig

AT_REST = BicycleState(*(0.0 for _ in BicycleState._fields))


class HandsOff:
    arms = Arms()

    def torque(self, steer: float, steer_rate: float, seen: BicycleState) -> float:
        del steer, steer_rate, seen
        return 0.0


class LetsAll:
    def check(self, steer: float, roll: float, torque: float) -> Verdict:
        del steer, roll
        return Verdict(torque, 0, None)


class Motor:
    """A virtual rig whose motor gives a part of what it is told."""

    def __init__(self, rig: VirtualRig, ratio: float) -> None:
        self.read, self.show, self.wait = rig.read, rig.show, rig.wait
        self._rig, self._ratio = rig, ratio

    def command(self, torque: float) -> float:
        self._rig.command(torque * self._ratio)
        return torque


NOISY: dict[str, Any] = {
    "angle_resolution": 5e-5, "rate_resolution": 5e-4, "angle_noise": 2.9e-4,
    "rate_noise": 2.8e-3, "rate_bias": 1.7e-3,
}  # fmt: skip


def recorded(
    rig: RigSettings, inertia: float, *, seed: int = 1, added: float = 0.0, ratio: float = 1.0
) -> BarRecord:
    bar = VirtualRig(
        rig, HandsOff(), name="bar", inertia=inertia + added, steer_axis_tilt=0.3, period=1e-3,
        step=5e-4, random=np.random.default_rng(seed),
    )  # fmt: skip
    excitation = Excitation(MOST_TORQUE, 9.0, inertia)
    return excite(Motor(bar, ratio), LetsAll(), excitation, AT_REST, added_inertia=added)


BARS = {
    "as the law asks": (0.2311, 0.03, 0.01, 0.001, 0.001),
    "light and late": (0.0427, 0.03, 0.05, 0.009, 0.004),
    "no friction": (0.2, 0.0, 0.0, 0.001, 0.002),
}


@pytest.mark.parametrize("name", BARS)
def test_the_virtual_rigs_figures_are_inside_the_intervals(name: str):
    inertia, coulomb, viscous, sensor_delay, motor_delay = BARS[name]
    rig = RigSettings(
        coulomb_friction=coulomb, viscous_friction=viscous, sensor_delay=sensor_delay,
        motor_delay=motor_delay, **NOISY,
    )  # fmt: skip
    found = identify_bar([recorded(rig, inertia)])
    truth = (inertia, coulomb, viscous, sensor_delay + motor_delay, 0.0)
    for figure, true in zip(found.all(), truth, strict=True):
        assert figure.low <= true <= figure.high, figure
    assert found.inertia.half < 0.01 * inertia
    assert found.delay.half < 5e-4
    assert found.rate_error == pytest.approx(2.8e-3, rel=0.05)
    assert found.torque_ratio is None


def coulombs_bar(random: np.random.Generator) -> tuple[BarRecord, dict[str, float]]:
    """A bar of its own: Coulomb's law with sticking, an offset, stepped at 20 us."""
    truth = {"inertia": 0.15, "coulomb_friction": 0.06, "viscous_friction": 0.08, "delay": 0.0057}
    excitation, fine, per_tick = Excitation(0.5, 12.0, 0.15), 2e-5, 50
    steer = rate = 0.0
    sent: list[float] = []
    rows = []
    late = round(truth["delay"] / fine)
    for tick in range(12_000):
        time = tick * 1e-3
        # Both sensors without delay: only the sum of delays shows.
        seen = steer + 1e-4 * random.standard_normal(), rate + 2e-3 * random.standard_normal()
        sent.append(excitation(time, *seen))
        rows.append((time, sent[-1], *seen))
        for k in range(per_tick):
            at = tick * per_tick + k - late
            torque = (sent[at // per_tick] if at >= 0 else 0.0) + 0.01
            free = rate + fine / 0.15 * (torque - 0.08 * rate)
            lost = fine / 0.15 * 0.06
            after = float(np.sign(free)) * max(abs(free) - lost, 0.0)
            steer, rate = steer + 0.5 * fine * (rate + after), after
    return BarRecord(*np.array(rows).T), truth


def test_another_bar_with_coulombs_own_friction_and_an_offset():
    record, truth = coulombs_bar(np.random.default_rng(3))
    found = identify_bar([record])
    for figure in found.all():
        true = truth.get(figure.name, 0.01)
        assert figure.low <= true <= figure.high, figure
    # As much as the sensors' noise: no piece is left at a beginning that does not fit.
    assert found.angle_error == pytest.approx(1e-4, rel=0.03)
    assert found.rate_error == pytest.approx(2e-3, rel=0.03)


def test_weights_tell_real_torque_from_commanded():
    """The inertia stays in commanded N m: what the loop turns with its torque."""
    rig = RigSettings(coulomb_friction=0.03, viscous_friction=0.02, **NOISY)
    records = [recorded(rig, 0.1, added=added, ratio=0.9) for added in (0.0, 0.08)]
    found = identify_bar(records)
    assert found.torque_ratio is not None
    assert found.torque_ratio.low <= 0.9 <= found.torque_ratio.high
    assert found.torque_ratio.half < 0.03
    assert found.inertia.value == pytest.approx(0.1 / 0.9, rel=0.01)
    assert found.coulomb_friction.value == pytest.approx(0.03 / 0.9, rel=0.05)


def test_a_bar_that_is_held_tells_nothing():
    record = recorded(RigSettings(coulomb_friction=1.0), 0.2)
    with pytest.raises(InputError, match=r"the bar moved by 0\.\d+ deg only"):
        identify_bar([record])


def test_a_record_that_is_too_short():
    time = np.arange(0.0, 1.0, 1e-3)
    with pytest.raises(InputError, match="too short"):
        identify_bar([BarRecord(time, time, time, time)])


def test_a_hand_on_the_bar_is_no_inertia():
    """Motion that no torque explains."""
    random = np.random.default_rng(0)
    time = np.arange(0.0, 5.0, 5e-3)
    rate = np.cumsum(random.standard_normal(len(time))) * 0.03
    steer = np.cumsum(rate) * 5e-3
    record = BarRecord(time, 0.4 * np.sin(9 * time), steer, rate)
    with pytest.raises(InputError, match="no inertia can be told from this"):
        identify_bar([record])


def test_a_delay_beyond_what_is_looked_for():
    rig = RigSettings(sensor_delay=0.06, motor_delay=0.06, **NOISY)
    with pytest.raises(InputError, match=r"the delay is not to be found between 0 and 0\.1 s"):
        identify_bar([recorded(rig, 0.2)])


def test_a_fit_that_does_not_converge_is_no_answer(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("bikesim.bench.identify_fit.MOST_EVALUATIONS", 2)
    with pytest.raises(InputError, match="does not converge"):
        identify_bar([recorded(RigSettings(coulomb_friction=0.03, **NOISY), 0.2)])


def test_a_record_with_a_gap_that_is_no_number():
    time = np.arange(0.0, 5.0, 5e-3)
    steer = np.sin(9 * time)
    steer[300] = np.nan
    with pytest.raises(InputError, match="no finite numbers"):
        identify_bar([BarRecord(time, steer, steer, steer)])


def test_the_excitation_keeps_to_its_torque_and_fades():
    excitation = Excitation(0.4, 10.0, 0.2)
    torques = [excitation(t, 0.3, -2.0) for t in np.linspace(0, 10, 2001).tolist()]
    assert max(map(abs, torques)) <= 0.4
    assert torques[0] == torques[-1] == 0.0


def test_no_more_than_half_a_newton_metre():
    with pytest.raises(InputError, match="at most 0"):
        Excitation(0.6, 10.0, 0.2)


class Stuck:
    """A bar that is where it is told, whatever the torque."""

    def __init__(self, steer: float) -> None:
        self._steer = steer
        self.sent: list[float] = []

    def read(self) -> Sample:
        return Sample(1.0 + 0.001 * len(self.sent), self._steer, 0.0)

    def command(self, torque: float) -> float:
        self.sent.append(torque)
        return torque

    def show(self, bicycle: BicycleState) -> None: ...

    def wait(self) -> None: ...


def test_a_bar_that_goes_too_far_ends_it():
    bar = Stuck(0.5)
    with pytest.raises(InputError, match=r"the bar went to \+29 deg"):
        excite(bar, LetsAll(), Excitation(0.5, 5.0, 0.2), AT_REST)
    assert bar.sent == []


def test_a_guard_that_stops_ends_it():
    class Stops:
        def check(self, steer: float, roll: float, torque: float) -> Verdict:
            del steer, roll, torque
            return Verdict(0.0, 0, Stop("fault 21: the emergency stop", fell=False))

    bar = Stuck(0.0)
    with pytest.raises(InputError, match="stopped: fault 21"):
        excite(bar, Stops(), Excitation(0.5, 5.0, 0.2), AT_REST)
    assert bar.sent == [0.0]
