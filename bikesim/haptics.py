"""The haptic cue of an experiment: what is made of the feedback torque before it is checked.

In this order: low pass, delay, scale (which switches during the run change, at once), limit. Where
the law gives no torque there stays none.
"""

from collections import deque
from collections.abc import Callable
from itertools import pairwise
from math import inf
from typing import Annotated, Any, ClassVar, TypeAlias

from pydantic import Field, Strict, field_validator

from bikesim.errors import InputError
from bikesim.settings import Settings

# A float for one rig; for a batch, an array with a value for each. As model.haptic has it, which
# is not imported here because a scenario is read before anything heavy is.
Real: TypeAlias = Any

_Time = Annotated[float, Field(ge=0, le=86400)]
_Scale = Annotated[float, Field(ge=-10, le=10)]
# TOML has lists, not tuples.
_List = Strict(False)


class HapticsSettings(Settings):
    """How the rider is given the torque of the law. The defaults: as it is."""

    table: ClassVar[str] = "haptics"

    scale: _Scale = Field(default=1.0, description="Of the feedback torque; 0: none, 1: the law's.")
    delay: Annotated[float, Field(ge=0, le=2)] = Field(
        default=0.0, description="Of the feedback torque [s], rounded to whole loop periods."
    )
    filter_cutoff: Annotated[float, Field(ge=0.01, le=1e5)] | None = Field(
        default=None,
        description="Low pass on the feedback torque, -3 dB [rad/s]; default: none.",
    )
    filter_order: Annotated[int, Field(ge=1, le=4)] = Field(
        default=2, description="Butterworth order."
    )
    limit: Annotated[float, Field(gt=0, le=100)] | None = Field(
        default=None, description="Largest torque that the rider is given [N m]; default: none."
    )
    switches: Annotated[tuple[Annotated[tuple[_Time, _Scale], _List], ...], _List] = Field(
        default=(), description="Pairs of time [s] and the scale from then on, rising."
    )

    @field_validator("switches")
    @classmethod
    def _in_order(cls, switches: tuple[tuple[float, float], ...]) -> tuple:
        for (earlier, _), (later, _) in pairwise(switches):
            if later <= earlier:
                raise ValueError(f"times must rise, but {later} follows {earlier}")
        return switches


def make_haptics(settings: HapticsSettings, period: float) -> Callable[[float, Real], Real]:
    """From time [s] and torque of the law [N m] to the torque given [N m], once every `period` [s].

    Floats, or arrays with a value for each rig. It keeps what it delays: one for each ride. Raises
    InputError for a delay below half a period and a cutoff that the period cannot carry.
    """
    if settings == HapticsSettings():
        return _unchanged
    return _Cue(settings, period)


def _unchanged(time: float, torque: Real) -> Real:
    return torque


class _Cue:
    def __init__(self, settings: HapticsSettings, period: float) -> None:
        self._filter = None
        if settings.filter_cutoff is not None:
            from bikesim.model.low_pass import LowPass

            self._filter = LowPass(
                settings.filter_cutoff, settings.filter_order, period, "haptics.filter_cutoff"
            )
        self._delay = _whole_periods(settings.delay, period)
        self._late: deque[Real] = deque()  # what has not arrived yet
        # A tick is meant when its time is nearest.
        self._times = [time - 0.5 * period for time, _ in settings.switches] + [inf]
        self._scales = [settings.scale, *(scale for _, scale in settings.switches)]
        self._now = 0
        self._limit = settings.limit

    def __call__(self, time: float, torque: Real) -> Real:
        if self._filter is not None:
            torque = self._filter(torque)
        if self._delay:
            self._late.append(torque)
            full = len(self._late) > self._delay
            torque = self._late.popleft() if full else 0.0 * torque
        while time >= self._times[self._now]:
            self._now += 1
        torque = self._scales[self._now] * torque
        limit = self._limit
        if limit is None:
            return torque
        if isinstance(torque, float):
            return min(max(torque, -limit), limit)
        return torque.clip(-limit, limit)


def _whole_periods(delay: float, period: float) -> int:
    count = round(delay / period)
    if delay and not count:
        raise InputError(
            f"haptics.delay = {delay} s: must be 0 or at least half the loop period, {period} s"
        )
    return count
