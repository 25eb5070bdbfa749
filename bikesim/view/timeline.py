"""Which moment of the record each frame of a video shows, and when."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError

# Of the stream [1/s]: divides by all usual frame rates.
CLOCK = 90_000
_MOST_FRAMES = 2_000_000


@dataclass(frozen=True)
class Timeline:
    """Frames of a video of a run that lasts `duration` [s].

    Frame k shows the run k / `fps` * `speed` after its begin; the last frame is the end of the run,
    shown at its own time where that falls between two frames. A frame that is less than `margin`
    [s] before the end is the end. The end is shown `hold` [s] of video longer.
    """

    duration: float
    fps: Fraction
    speed: float = 1.0
    margin: float = 0.0
    hold: float = 0.0

    def __post_init__(self) -> None:
        if not 1 <= self.fps <= 240:
            raise InputError(f"--fps {float(self.fps):g}: from 1 to 240 frames a second")
        if not 0.001 <= self.speed <= 1000:
            raise InputError(f"--speed {self.speed:g}: from 0.001 to 1000; 0.25 is slow motion")
        if self.duration / self._step > _MOST_FRAMES:
            raise InputError(
                f"{self.duration:g} s at --fps {float(self.fps):g} and --speed {self.speed:g}: "
                f"more than {_MOST_FRAMES} frames"
            )

    @property
    def _step(self) -> float:
        return float(Fraction(self.speed) / self.fps)

    @property
    def _held(self) -> int:
        return round(self.hold * self.fps)

    def elapsed(self) -> NDArray[np.float64]:
        """Time since the begin of the run that each frame shows [s]."""
        whole = int(self.duration / self._step + 1e-9)
        left = self.duration - whole * self._step
        times = np.arange(whole + 1 + int(left > self.margin), dtype=np.float64) * self._step
        times[-1] = self.duration
        return np.append(times, np.full(self._held, self.duration))

    def ticks(self) -> NDArray[np.int64]:
        """When each frame is shown, in 1/CLOCK s; rises from frame to frame."""
        elapsed = self.elapsed()
        ticks = np.round(np.arange(len(elapsed)) * float(CLOCK / self.fps)).astype(np.int64)
        last = len(elapsed) - self._held - 1
        if last > 0:
            end = max(ticks[last - 1] + 1, round(self.duration / self.speed * CLOCK))
            ticks[last:] += end - ticks[last]
        return ticks


def frames_a_second(value: float) -> Fraction:
    """29.97 is 30000/1001, as everywhere in video."""
    for exact in (Fraction(24000, 1001), Fraction(30000, 1001), Fraction(60000, 1001)):
        if abs(value - exact) < 0.005:
            return exact
    return Fraction(value).limit_denominator(1000)
