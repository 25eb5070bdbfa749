import math
from itertools import islice

import numpy as np
import pytest
from scipy.signal import freqs, lfilter, lsim, welch

from bikesim.rider.muscle import Neuromuscular, remnant

OMEGA, ZETA = 30.0, 0.707  # [H12]
G_NM = ([OMEGA**2], [1, 2 * ZETA * OMEGA, OMEGA**2])


@pytest.mark.parametrize("step", [1e-4, 1e-3, 1e-2])
def test_the_answer_to_a_step_is_exact(step: float):
    muscle = Neuromuscular(OMEGA, ZETA, step)
    ours = [muscle(1.0) for _ in range(200)]
    times = step * np.arange(1, 201)
    decay, damped = ZETA * OMEGA, OMEGA * math.sqrt(1 - ZETA**2)
    theirs = 1 - np.exp(-decay * times) * (
        np.cos(damped * times) + decay / damped * np.sin(damped * times)
    )
    assert ours == pytest.approx(theirs, abs=1e-12)


def test_the_answer_to_any_held_torque_is_scipys():
    intended = np.random.default_rng(1).normal(size=300)
    muscle = Neuromuscular(OMEGA, ZETA, 2e-3)
    ours = [muscle(value) for value in intended]
    times = 2e-3 * np.arange(301)
    _, theirs, _ = lsim(G_NM, [*intended, 0.0], times, interp=False)
    assert ours == pytest.approx(theirs[1:], abs=1e-11)


@pytest.mark.parametrize("frequency", [3.0, 30.0, 90.0])
def test_the_frequency_response_is_that_of_the_filter(frequency: float):
    step, muscle = 1e-4, Neuromuscular(OMEGA, ZETA, 1e-4)
    times = step * np.arange(40_000)
    out = np.array([muscle(value) for value in np.sin(frequency * times)])
    # Half a step: the intended torque is held over one.
    late = times[-20_000:] + step / 2
    basis = np.column_stack([np.sin(frequency * late), np.cos(frequency * late)])
    (in_phase, quadrature), *_ = np.linalg.lstsq(basis, out[-20_000:], rcond=None)
    _, response = freqs(*G_NM, worN=[frequency])
    assert complex(in_phase, quadrature) == pytest.approx(complex(response[0]), abs=1e-3)


@pytest.mark.parametrize(("frequency", "ratio"), [(1000.0, 0.7), (1000.0, 10.0), (30.0, 1.0)])
def test_any_muscle_that_may_be_set_settles_at_the_intended_torque(frequency: float, ratio: float):
    """Also where the physics step is much longer than its time constant."""
    muscle = Neuromuscular(frequency, ratio, 0.01)
    torque = 0.0
    for _ in range(200):
        torque = muscle(2.0)
    assert torque == pytest.approx(2.0, rel=1e-6)


class TestRemnant:
    @pytest.mark.parametrize("step", [1e-4, 1e-3, 1e-2])
    def test_its_rms_is_as_asked_whatever_the_step(self, step: float):
        noise = self.noise(0.3, 50.0, step, 400_000)
        # Independent values in it: 400 000 steps over twice the correlation time of 1/50 s.
        independent = 400_000 / max(1, 2 / 50 / step)
        assert noise.std() == pytest.approx(0.3, rel=4 / math.sqrt(2 * independent))

    @pytest.mark.parametrize("step", [1e-3, 1e-2])
    def test_its_bandwidth_is_as_asked_whatever_the_step(self, step: float):
        """Neighbours t apart correlate as exp(-bandwidth t)."""
        noise = self.noise(1.0, 20.0, step, 400_000)
        lag = round(0.05 / step)
        correlation = float(np.mean(noise[lag:] * noise[:-lag]) / np.mean(noise**2))
        assert correlation == pytest.approx(math.exp(-20 * 0.05), abs=0.02)

    def test_its_spectrum_is_that_of_a_first_order_lag(self):
        noise = self.noise(1.0, 20.0, 1e-3, 400_000)
        frequency, density = welch(noise, fs=1000.0, nperseg=4096)
        omega = 2 * math.pi * frequency
        expected = 4 * 20 / (20**2 + omega**2)  # one-sided, in units²/Hz, variance 1
        for low, high in ((0.5, 2), (2, 8), (8, 32)):
            band = (frequency > low) & (frequency < high)
            assert density[band].mean() == pytest.approx(expected[band].mean(), rel=0.1)

    def test_it_starts_as_it_goes_on(self):
        first = [next(remnant(0.3, 1.0, 1e-3, np.random.default_rng(k))) for k in range(2000)]
        assert np.std(first) == pytest.approx(0.3, rel=0.07)

    def test_it_is_scipys_filter_of_white_noise(self):
        step, decay = 1e-3, math.exp(-10 * 1e-3)
        random = np.random.default_rng(7)
        first, white = random.standard_normal(), random.standard_normal(4096)[:999]
        kicks = 0.2 * math.sqrt(1 - decay**2) * white
        theirs = lfilter([1], [1, -decay], [0.2 * first, *kicks])
        ours = list(islice(remnant(0.2, 10.0, step, np.random.default_rng(7)), 1000))
        assert ours == pytest.approx(theirs, abs=1e-14)

    def test_none_is_zero(self):
        assert set(islice(remnant(0.0, 10.0, 1e-3, np.random.default_rng(1)), 100)) == {0.0}

    @staticmethod
    def noise(rms: float, bandwidth: float, step: float, count: int) -> np.ndarray:
        source = remnant(rms, bandwidth, step, np.random.default_rng(3))
        return np.fromiter(source, float, count)
