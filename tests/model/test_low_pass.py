import math

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from bikesim.errors import InputError
from bikesim.model.low_pass import LowPass


def test_is_scipys_butterworth():
    signal = np.random.default_rng(1).normal(size=500)
    low_pass = LowPass(60.0, 2, 1e-3, "key")
    low_pass(0.0)
    theirs = sosfilt(butter(2, 60.0 / (2 * math.pi), fs=1000.0, output="sos"), signal)
    assert [low_pass(value) for value in signal] == pytest.approx(theirs, abs=1e-12)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_lets_half_the_power_through_at_its_cutoff(order: int):
    low_pass = LowPass(60.0, order, 1e-3, "key")
    times = 1e-3 * np.arange(20_000)
    out = np.array([low_pass(value) for value in np.sin(60.0 * times)])[10_000:]
    assert out.std() / math.sqrt(0.5) == pytest.approx(math.sqrt(0.5), rel=2e-3)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_starts_at_rest_at_the_first_value(order: int):
    low_pass = LowPass(60.0, order, 1e-3, "key")
    assert [low_pass(0.3) for _ in range(50)] == pytest.approx([0.3] * 50)


@pytest.mark.parametrize("cutoff", [3141.6, 1e6])
def test_above_half_the_sampling_frequency_is_refused(cutoff: float):
    with pytest.raises(InputError, match=r"rig\.filter_cutoff = .* half the sampling frequency"):
        LowPass(cutoff, 2, 1e-3, "rig.filter_cutoff")


def test_arrays_give_what_each_gives_alone():
    signals = np.random.default_rng(2).normal(size=(200, 3))
    together = LowPass(60.0, 2, 1e-3, "key")
    many = np.array([together(values) for values in signals])
    for k in range(3):
        alone = LowPass(60.0, 2, 1e-3, "key")
        assert [alone(value) for value in signals[:, k].tolist()] == many[:, k].tolist()
