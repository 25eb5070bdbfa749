import math

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from bikesim.errors import InputError
from bikesim.haptics import HapticsSettings, make_haptics

PERIOD = 1e-3
SIGNAL = np.random.default_rng(3).normal(size=400).tolist()


def given(settings: HapticsSettings, torques, period: float = PERIOD) -> list:
    """What is given at each tick."""
    cue = make_haptics(settings, period)
    return [cue(k * period, torque) for k, torque in enumerate(torques)]


def test_by_default_it_is_the_torque_of_the_law():
    assert given(HapticsSettings(), SIGNAL) == SIGNAL
    many = np.ones(3)
    assert make_haptics(HapticsSettings(), PERIOD)(0.0, many) is many


def test_scaled():
    assert given(HapticsSettings(scale=-0.5), SIGNAL) == [-0.5 * torque for torque in SIGNAL]


@pytest.mark.parametrize(
    ("delay", "ticks"), [(0.02, 20), (0.0204, 20), (0.0206, 21), (5e-4 + 1e-9, 1)]
)
def test_delayed_by_whole_periods_and_nothing_before(delay: float, ticks: int):
    assert given(HapticsSettings(delay=delay), SIGNAL) == [0.0] * ticks + SIGNAL[:-ticks]


def test_a_delay_that_would_be_none_is_refused():
    with pytest.raises(InputError, match=r"haptics\.delay = 0\.0004 s: must be 0 or at least"):
        make_haptics(HapticsSettings(delay=0.0004), PERIOD)


@pytest.mark.parametrize("order", [1, 2])
def test_filtered_as_a_butterworth(order: int):
    ours = given(HapticsSettings(filter_cutoff=40.0, filter_order=order), [0.0, *SIGNAL])
    sections = butter(order, 40.0 / (2 * math.pi), fs=1 / PERIOD, output="sos")
    assert ours == pytest.approx(sosfilt(sections, [0.0, *SIGNAL]), abs=1e-12)


def test_limited():
    ours = given(HapticsSettings(limit=0.7), SIGNAL)
    assert ours == np.clip(SIGNAL, -0.7, 0.7).tolist()


def test_switched_at_its_time():
    cue = HapticsSettings(switches=((0.1, 0.0), (0.3, 2.0)))
    ours = given(cue, [1.0] * 400)
    assert ours == [1.0] * 100 + [0.0] * 200 + [2.0] * 100


@pytest.mark.parametrize("period", [1e-3, 5e-4, 1 / 300, 0.02])
def test_a_switch_is_at_the_tick_nearest_to_its_time(period: float):
    """Also where the time of a tick is rounded."""
    for tick in range(1, 200):
        ours = given(HapticsSettings(switches=((tick * period, 0.0),)), [1.0] * 201, period)
        assert ours == [1.0] * tick + [0.0] * (201 - tick)


def test_a_switch_waits_for_no_delay_and_the_limit_comes_last():
    cue = HapticsSettings(delay=0.05, scale=0.0, limit=1.5, switches=((0.1, 2.0),))
    assert given(cue, [1.0] * 120) == [0.0] * 100 + [1.5] * 20


@pytest.mark.parametrize(
    "cue",
    [
        HapticsSettings(scale=0.3, delay=0.01, limit=0.2),
        HapticsSettings(filter_cutoff=30.0, switches=((0.05, 0.5),)),
    ],
)
def test_arrays_give_what_each_gives_alone(cue: HapticsSettings):
    torques = np.random.default_rng(4).normal(size=(100, 5))
    together = np.array(given(cue, list(torques)))
    for k in range(5):
        assert given(cue, torques[:, k].tolist()) == together[:, k].tolist()


def test_haptics_off_stay_off():
    cue = HapticsSettings(scale=2.0, delay=0.01, filter_cutoff=30.0, limit=1.0)
    assert set(given(cue, [0.0] * 50)) == {0.0}


def test_no_number_is_not_hidden_from_the_guard():
    assert math.isnan(given(HapticsSettings(scale=0.5, limit=1.0), [math.nan])[0])


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ({"scale": 11.0}, "haptics.scale = 11.0: must be at least -10 and at most 10"),
        ({"limit": 0.0}, "haptics.limit = 0.0: must be above 0 and at most 100"),
        ({"switches": [[2, 0], [1, 1]]}, "haptics.switches: times must rise, but 1.0 follows 2.0"),
        ({"switches": [[2]]}, "haptics.switches.0.1: must be given"),
        ({"scal": 1.0}, "unknown key of [haptics] 'scal'; did you mean scale?"),
    ],
)
def test_refused_in_one_line(keys, told: str):
    with pytest.raises(InputError) as refused:
        HapticsSettings(**keys)
    assert str(refused.value) == told


def test_a_cutoff_above_half_the_sampling_frequency_is_refused():
    with pytest.raises(InputError, match=r"haptics\.filter_cutoff = 4000\.0 rad/s"):
        make_haptics(HapticsSettings(filter_cutoff=4000.0), PERIOD)
