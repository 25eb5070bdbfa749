"""What the loop may expect of every rig; a bench will have to pass it too."""

import math
from collections.abc import Callable

import pytest

from bikesim.model.haptic import BicycleState
from bikesim.record.channels import TICK_CHANNELS, TIMING_CHANNELS
from bikesim.rig.base import Rig, RigFinished, RigInfo, Sample
from bikesim.rig.playback import PlaybackRig
from bikesim.rig.settings import rig_names


def playback(samples: int = 100) -> PlaybackRig:
    info = RigInfo("a recording", 1e-3, 0.0427, math.pi)
    return PlaybackRig(info, [Sample(k * 1e-3, 0.01 * k, 10.0) for k in range(samples)])


@pytest.fixture(params=[*rig_names(), "playback"])
def make(request: pytest.FixtureRequest, make_rig) -> Callable[[], Rig]:
    if request.param == "playback":
        return playback
    return lambda: make_rig(name=request.param)


@pytest.fixture
def rig(make: Callable[[], Rig]) -> Rig:
    return make()


def tick(rig: Rig, torque: float, bicycle: BicycleState) -> tuple[Sample, float, tuple[float, ...]]:
    sample = rig.read()
    sent = rig.command(torque)
    rig.show(bicycle)
    telemetry = rig.telemetry()
    rig.wait()
    return sample, sent, telemetry


def test_it_tells_what_it_is(rig: Rig):
    info = rig.info
    assert info.name
    assert info.period == 1e-3
    assert info.inertia > 0
    assert info.steer_stop > 0


def test_its_telemetry_is_one_float_for_each_of_its_channels(rig: Rig, upright: BicycleState):
    for _ in range(3):
        _, _, telemetry = tick(rig, 0.1, upright)
        assert len(telemetry) == len(rig.info.channels)
        assert all(type(value) is float for value in telemetry)


def test_its_channels_have_names_of_their_own(rig: Rig):
    names = [channel.name for channel in rig.info.channels]
    taken = {channel.name for channel in (*TICK_CHANNELS, *TIMING_CHANNELS)}
    assert len(set(names)) == len(names)
    assert not taken & set(names)


def test_its_samples_are_finite_floats(rig: Rig, upright: BicycleState):
    for _ in range(50):
        sample, _, _ = tick(rig, 0.1, upright)
        assert all(type(value) is float and math.isfinite(value) for value in sample)


def test_its_time_begins_at_zero_and_goes_on_by_its_period(rig: Rig, upright: BicycleState):
    times = [tick(rig, 0.0, upright)[0].time for _ in range(50)]
    assert times == pytest.approx([k * rig.info.period for k in range(50)], abs=1e-12)


@pytest.mark.parametrize("torque", [0.0, 0.7, -2.345, 99.0])
def test_it_says_what_it_sent(rig: Rig, upright: BicycleState, torque: float):
    _, sent, _ = tick(rig, torque, upright)
    assert type(sent) is float
    assert abs(sent) <= abs(torque) + 0.006
    assert sent * torque >= 0


def test_two_of_a_kind_say_the_same(make: Callable[[], Rig], upright: BicycleState):
    first, second = make(), make()
    for k in range(50):
        torque = 0.5 * math.sin(k)
        assert tick(first, torque, upright) == tick(second, torque, upright)


def test_it_may_be_closed_twice(rig: Rig, upright: BicycleState):
    tick(rig, 0.1, upright)
    rig.close()
    rig.close()


def test_it_may_be_closed_before_its_first_tick(rig: Rig):
    rig.close()


class TestPlayback:
    def test_it_gives_the_recorded_samples(self, upright: BicycleState):
        rig = playback(3)
        samples = [tick(rig, 5.0, upright)[0] for _ in range(3)]
        assert samples == [Sample(0, 0, 10), Sample(1e-3, 0.01, 10), Sample(2e-3, 0.02, 10)]

    def test_it_finishes_after_the_last(self, upright: BicycleState):
        rig = playback(1)
        tick(rig, 0.0, upright)
        with pytest.raises(RigFinished, match="end of the recording"):
            rig.read()

    def test_it_keeps_what_was_commanded(self, upright: BicycleState):
        rig = playback(3)
        for torque in (1.0, -2.0, 3.0):
            tick(rig, torque, upright)
        assert rig.commanded == [1, -2, 3]
