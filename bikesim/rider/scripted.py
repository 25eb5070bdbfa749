"""Riders who give a torque by the clock, whatever the bicycle does.

For identification and comparison: a step, a multisine, a chirp, what a file says, or what a person
gave in a recorded run. Each is a torque by the time [s] since its own begin, and zero outside.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from bikesim.errors import InputError
from bikesim.model.real import Real
from bikesim.rider.base import Setting, Sight
from bikesim.rider.script_settings import ScriptSettings
from bikesim.rider.torque_file import check_samples, read_samples
from bikesim.textfile import located

TorqueByTime = Callable[[float], float]


class Scripted:
    """The torque of a script [N m], at times counted in physics steps from the first one.

    All riders of a batch have the same script. Raises InputError for a file that is no torque.
    """

    def __init__(self, setting: Setting, *, script: ScriptSettings) -> None:
        self._torque = torque_by_time(script)
        self._start = _figure(script.start)
        self._stop = _stop(script)
        self._step = setting.step
        self._steps = 0

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """One physics step; see the class."""
        time = self._steps * self._step
        self._steps += 1
        torque = self._torque(time - self._start) if self._start <= time < self._stop else 0.0
        return torque if isinstance(steer, float) else np.full(np.shape(steer), torque)


def torque_by_time(script: ScriptSettings) -> TorqueByTime:
    """The torque [N m] by the time [s] since the script's begin."""
    match script.kind:
        case "step":
            level = _figure(script.torque)
            return lambda _: level
        case "multisine":
            return Multisine(script)
        case "chirp":
            return Chirp(script)
    if not script.samples and script.kind == "record":
        raise InputError("rider.script: the torque of the record must be read first")
    if not script.samples:
        return Sampled(read_samples(Path(script.file or "")))
    with located("rider.script.samples"):
        check_samples(script.samples)
    return Sampled(script.samples)


class Multisine:
    """Σ a sin(ω_k t + φ_k), k = 1..n, with a = torque_rms √(2/n); `omega` has ω_k [rad/s], (n,).

    The frequencies are spread evenly on a logarithmic scale and moved to whole multiples of
    2π / repeat, no two the same. Phases of Schroeder (1970, IEEE Trans. Inf. Theory 16), φ_k =
    -π k (k - 1) / n, which keep the peaks low, or drawn evenly from 0 to 2π.
    """

    def __init__(self, script: ScriptSettings) -> None:
        self.omega = 2 * math.pi / _figure(script.repeat) * np.array(_cycles(script))
        count = len(self.omega)
        if script.phases == "random":
            phases = 2 * math.pi * np.random.default_rng(script.seed).random(count)
        else:
            k = np.arange(1, count + 1)
            phases = -math.pi * k * (k - 1) / count
        self._lines = list(zip(self.omega.tolist(), phases.tolist(), strict=True))
        self._amplitude = _figure(script.torque_rms) * math.sqrt(2 / count)

    def __call__(self, time: float) -> float:
        """The torque [N m]."""
        return self._amplitude * sum(math.sin(omega * time + phi) for omega, phi in self._lines)


class Chirp:
    """torque · sin θ(t) with a frequency θ̇ from ω_0 to ω_1 [rad/s] over the duration D.

    Linear: θ = ω_0 t + (ω_1 - ω_0) t² / (2 D). Logarithmic: θ = ω_0 D (rᵗᐟᴰ - 1) / ln r, r =
    ω_1 / ω_0.
    """

    def __init__(self, script: ScriptSettings) -> None:
        self._torque, self._duration = _figure(script.torque), _figure(script.duration)
        self._from, self._to = _figure(script.lowest), _figure(script.highest)
        self._rise = math.log(self._to / self._from) if script.sweep == "logarithmic" else 0.0

    def __call__(self, time: float) -> float:
        """The torque [N m]."""
        part = time / self._duration
        if self._rise:
            cycles = math.expm1(self._rise * part) / self._rise
        else:
            cycles = part + 0.5 * (self._to / self._from - 1) * part * part
        return self._torque * math.sin(self._from * self._duration * cycles)


class Sampled:
    """Linear between samples of time [s] and torque [N m]; zero outside them."""

    def __init__(self, samples: Sequence[tuple[float, float]]) -> None:
        self._times = [time for time, _ in samples]
        self._torques = [torque for _, torque in samples]

    def __call__(self, time: float) -> float:
        """The torque [N m]."""
        times, torques = self._times, self._torques
        if not times[0] <= time <= times[-1]:
            return 0.0
        i = min(bisect_right(times, time), len(times) - 1)
        part = (time - times[i - 1]) / (times[i] - times[i - 1])
        return torques[i - 1] + part * (torques[i] - torques[i - 1])


def _stop(script: ScriptSettings) -> float:
    if script.duration is not None:
        return _figure(script.start) + script.duration
    return math.inf if script.stop is None else script.stop


def check_band(script: ScriptSettings) -> None:
    """Raises InputError where the lines of a multisine do not fit, or a chirp falls."""
    lowest, highest = _figure(script.lowest), _figure(script.highest)
    if highest < lowest:
        raise InputError(
            f"rider.script.highest = {highest:g} rad/s: must be at least lowest, {lowest:g}"
        )
    if script.kind == "multisine":
        _cycles(script)


def _cycles(script: ScriptSettings) -> list[int]:
    """Whole cycles of each line of a multisine in its time of repetition, rising."""
    lines, lowest, highest = (
        int(_figure(script.lines)),
        _figure(script.lowest),
        _figure(script.highest),
    )
    base = 2 * math.pi / _figure(script.repeat)
    first, last = math.ceil(lowest / base - 1e-9), math.floor(highest / base + 1e-9)
    if last - first + 1 < lines or first < 1:
        raise InputError(
            f"rider.script.lines = {lines}: from {lowest:g} to {highest:g} rad/s there are "
            f"{max(0, last - first + 1)} frequencies with whole cycles in repeat = "
            f"{script.repeat:g} s; take fewer lines, a wider band or a longer repeat"
        )
    wanted = np.geomspace(first, last, lines)
    cycles: list[int] = []
    for k, want in enumerate(wanted):
        # Above the one before it, and leaving room for those to come.
        least = cycles[-1] + 1 if cycles else first
        cycles.append(min(max(round(float(want)), least), last - (lines - 1 - k)))
    return cycles


def _figure(value: float | None) -> float:
    assert value is not None, "settings must be resolved"
    return value
