import math
from typing import Any

import numpy as np
import pytest
from scipy.signal import welch

from bikesim.experiment.disturbances import Disturbance
from bikesim.experiment.wind import AIR_DENSITY, Gust, Turbulence, side_force


def _wind(seed: int, seconds: float, period: float = 0.01, speed: float = 5.0, **figures: Any):
    settings = Disturbance(kind="wind", **figures)
    made = Turbulence(settings, speed, period, np.random.default_rng(seed))
    return made(np.linspace(0.0, seconds, round(seconds / period), endpoint=False))


class TestForce:
    def test_of_a_bicycle_that_stands_is_the_drag_of_the_wind(self):
        force = side_force(Disturbance(kind="gust", drag_area=0.5), np.array([4.0, -4.0]), 0.0)
        assert force == pytest.approx([0.25 * AIR_DENSITY * 16, -0.25 * AIR_DENSITY * 16])

    def test_is_the_side_part_of_the_drag_in_the_air_that_comes(self):
        """Wind 3 to the side, 4 ahead: 5 m/s of air, three fifths of its drag to the side."""
        force = side_force(Disturbance(kind="gust", drag_area=0.5), np.array([3.0]), 4.0)
        assert force == pytest.approx(0.25 * AIR_DENSITY * 25 * 3 / 5)


def test_a_gust_swells_to_its_peak_and_goes():
    gust = Gust(Disturbance(kind="gust", start=1.0, duration=2.0, wind_peak=-6.0))
    assert gust(np.array([0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 9.0])) == pytest.approx(
        [0, 0, -3, -6, -3, 0, 0], abs=1e-12
    )


class TestTurbulence:
    def test_its_root_mean_square(self):
        winds = [_wind(seed, 400.0, wind_rms=2.0, wind_length=5.0) for seed in range(10)]
        assert np.sqrt(np.mean(np.square(winds))) == pytest.approx(2.0, rel=0.03)

    def test_its_spectrum_is_drydens(self):
        """MIL-F-8785C: Φ(ω) = σ² τ / π · (1 + 3 (τ ω)²) / (1 + (τ ω)²)², for ω of both signs."""
        tau = 2.0  # 10 m at 5 m/s
        powers = [welch(_wind(s, 2000.0, wind_rms=1.5), fs=100, nperseg=8192)[1] for s in range(8)]
        hertz, _ = welch(np.zeros(8192), fs=100, nperseg=8192)
        x = (tau * 2 * np.pi * hertz) ** 2
        # Welch's density is per Hz and one-sided, twice 2π times that of ω.
        density = 4 * np.pi * 1.5**2 * tau / (2 * np.pi) * (1 + 3 * x) / (1 + x) ** 2
        band = (hertz > 0.03) & (hertz < 5)
        assert np.mean(powers, axis=0)[band] == pytest.approx(density[band], rel=0.25)
        assert np.mean(np.mean(powers, axis=0)[band] / density[band]) == pytest.approx(1, abs=0.03)

    @pytest.mark.parametrize("period", [1e-3, 0.02])
    def test_is_the_same_process_at_any_period(self, period: float):
        """Correlation of Dryden's lateral turbulence: (1 - t / 2τ) exp(-t / τ)."""
        lag = round(0.4 / period)
        winds = np.array([_wind(s, 20 * period * lag, period, wind_length=2.0) for s in range(400)])
        correlation = np.mean(winds[:, 0] * winds[:, lag]) / np.mean(winds**2)
        assert correlation == pytest.approx(0.5 * math.exp(-1), abs=0.12)

    def test_begins_and_stops(self):
        wind = _wind(1, 4.0, start=1.0, stop=3.0)
        assert np.flatnonzero(wind).min() == 100
        assert np.flatnonzero(wind).max() == 299

    def test_slow_air_over_short_periods_is_still_noise(self):
        wind = _wind(1, 1.0, 1e-4, speed=0.0, wind_length=1e4)
        assert np.isfinite(wind).all()
        assert np.diff(wind).any()

    def test_in_parts_it_is_the_same(self):
        settings = Disturbance(kind="wind")
        whole, parts = (Turbulence(settings, 5.0, 0.01, np.random.default_rng(3)) for _ in range(2))
        time = np.linspace(0.0, 3.0, 300, endpoint=False)
        split = np.concatenate([parts(time[:100]), parts(time[100:])])
        assert split == pytest.approx(whole(time), abs=1e-12)
