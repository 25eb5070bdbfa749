"""What every rider must do, tried on any of them: for those who write their own."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.errors import InputError
from bikesim.model.haptic import BicycleState
from bikesim.model.real import Real
from bikesim.rider.base import Rider, Setting
from bikesim.rider.building import make_rider, make_riders
from bikesim.rider.custom import class_figures
from bikesim.rider.kinds import kind_of
from bikesim.rider.settings import RiderSettings
from bikesim.rider.vision import VisionSettings

_TIME = 1.5  # s, of riding
_TICK = 2  # physics steps
_SHOWN = VisionSettings()
# NumPy's sine of an array may differ from that of a float in the last bit.
_ROUNDING = 1e-12
_RIDERS = 3
Array = NDArray[np.float64]
_Moment = tuple[float, float, BicycleState]


class Finding(NamedTuple):
    """One thing that a rider must do: whether he does, and what is to be said of it."""

    what: str
    passed: bool
    detail: str


class _Wrong(Exception):
    """A promise that is not kept; its text says how."""


def check(settings: RiderSettings, setting: Setting) -> list[Finding]:
    """Tries a rider on made-up rides in a setting, alone and in a batch of three.

    What the rider raises is what is found; one who cannot be made is asked no more.
    """
    trial = _Trial(settings, setting)
    made = _found("can be made", trial.can_be_made)
    if not made.passed:
        return [made]
    promises: list[tuple[str, Callable[[], str]]] = [
        ("gives one finite number for floats", trial.gives_floats),
        ("gives the same again", trial.gives_the_same_again),
        ("keeps his state to himself", trial.keeps_his_state),
        ("gives an array for arrays", trial.gives_arrays),
        ("gives in a batch what he gives alone", trial.gives_what_he_gives_alone),
        ("writes into no array that he is given", trial.writes_into_none),
        ("every figure changes something", trial.figures_matter),
    ]
    return [made, *(_found(what, promise) for what, promise in promises)]


def _found(what: str, promise: Callable[[], str]) -> Finding:
    try:
        return Finding(what, True, promise())
    except (InputError, _Wrong) as error:
        return Finding(what, False, str(error))


class _Trial:
    def __init__(self, settings: RiderSettings, setting: Setting) -> None:
        self._settings, self._setting = settings, replace(setting, speed=float(setting.speed))
        self._rides = [list(_ride(i, self._setting)) for i in range(_RIDERS)]

    def can_be_made(self) -> str:
        arms = self._alone().arms
        if not all(math.isfinite(one) and one >= 0 for one in arms):
            raise _Wrong(f"arms {tuple(arms)}: must not be negative")
        return _figures_told(self._figures())

    def gives_floats(self) -> str:
        torques = self._torques_alone()
        strange = [one for one in torques if type(one) is not float or not math.isfinite(one)]
        if strange:
            raise _Wrong(f"gave {strange[0]!r}")
        return f"within {max(map(abs, torques)):.3g} N m for 0.1 rad of roll and steer"

    def gives_the_same_again(self) -> str:
        _same(self._torques_alone(), self._torques_alone(), "a second time")
        return f"{_TIME:g} s, same seed"

    def keeps_his_state(self) -> str:
        """Two at once, of whom one rides otherwise."""
        one, other = self._alone(), self._alone()
        torques = []
        for mine, his in zip(self._rides[0], self._rides[1], strict=True):
            other.torque(*his)
            torques.append(one.torque(*mine))
        _same(self._torques_alone(), torques, "beside another one")
        return "two riders at once"

    def gives_arrays(self) -> str:
        torques = self._torques_of_many(self._all())
        wrong = [one for one in torques if np.shape(one) != (_RIDERS,)]
        if wrong:
            raise _Wrong(f"gave a shape of {np.shape(wrong[0])} for {_RIDERS} riders")
        if not all(np.isfinite(one).all() for one in torques):
            raise _Wrong("gave what is not finite")
        return f"{_RIDERS} riders"

    def gives_what_he_gives_alone(self) -> str:
        """With figures of his own for each, as in an experiment."""
        each = self._all()
        alone = np.transpose([self._torques_alone(one, i) for i, one in enumerate(each)])
        many = np.array(self._torques_of_many(each))
        return _same(alone, many, "in a batch")

    def writes_into_none(self) -> str:
        """They are the bar's, and what the bicycle goes on from; keeping them is no harm."""
        self._torques_of_many(self._all(), writeable=False)
        return "of bar and bicycle"

    def figures_matter(self) -> str:
        plain = self._torques_alone()
        without = [
            name
            for name, value in self._figures().items()
            if self._torques_alone(self._with({name: _other(value)})) == plain
        ]
        if without:
            raise _Wrong(f"on these rides nothing changes with {', '.join(without)}")
        return ", ".join(self._figures()) or "he has none"

    def _figures(self) -> dict[str, float]:
        """Those of his brain that are numbers."""
        settings = self._settings
        if settings.custom:
            return {**class_figures(settings.name), **(settings.figures or {})}
        values = {key: getattr(settings, key) for key in kind_of(settings.name).figures}
        return {key: one for key, one in values.items() if isinstance(one, float)}

    def _with(self, figures: dict[str, float]) -> RiderSettings:
        known = self._settings.model_dump()
        if self._settings.custom:
            return RiderSettings(**{**known, "figures": {**known["figures"], **figures}})
        return RiderSettings(**{**known, **figures})

    def _all(self) -> list[RiderSettings]:
        """Riders of a batch: as he is, and with each figure a bit smaller and larger."""
        return [
            self._with({key: part * value for key, value in self._figures().items()})
            for part in (1.0, 0.95, 1.05)
        ]

    def _alone(self, settings: RiderSettings | None = None, seed: int = 0) -> Rider:
        random = np.random.default_rng(seed)
        return make_rider(settings or self._settings, self._setting, _SHOWN, random)

    def _torques_alone(self, settings: RiderSettings | None = None, i: int = 0) -> list[float]:
        rider = self._alone(settings, i)
        return [rider.torque(*felt_and_seen) for felt_and_seen in self._rides[i]]

    def _torques_of_many(
        self, each: Sequence[RiderSettings], writeable: bool = True
    ) -> list[Array]:
        randoms = [np.random.default_rng(seed) for seed in range(len(each))]
        rider = make_riders(each, self._setting, [_SHOWN] * len(each), randoms)
        rides = zip(*self._rides, strict=True)
        return list(_torques(rider, rides, writeable))


def _ride(i: int, setting: Setting) -> Iterator[_Moment]:
    """Steer, its rate and the bicycle at each physics step: a sway, another for another `i`."""
    seen = None
    for k in range(round(_TIME / setting.step)):
        t = k * setting.step
        if k % _TICK == 0 or seen is None:
            roll, roll_rate = _sway(t, 0.1, 1.7 + 0.1 * i, 0.3)
            heading, _ = _sway(t, 0.1, 0.9 + 0.1 * i, 0.2 + i)
            (y, _), x = _sway(t, 0.5, 0.7, 0.1 * i), setting.speed * t
            seen = BicycleState(
                t, 0.0, 0.0, setting.speed, roll, roll_rate, 0.0, heading, x, y, x, *(0.0,) * 4
            )
        yield *_sway(t, 0.1, 2.3 + 0.2 * i, 0.1), seen


def _sway(t: float, amplitude: float, omega: float, phase: float) -> tuple[float, float]:
    return (
        amplitude * math.sin(omega * t + phase),
        amplitude * omega * math.cos(omega * t + phase),
    )


def _torques(
    rider: Rider, rides: Iterator[tuple[_Moment, ...]], writeable: bool
) -> Iterator[Array]:
    shown = seen = None
    for ride in rides:
        now = ride[0][2]
        if seen is None or now is not shown:
            shown, signals = now, list(zip(*(one[2] for one in ride), strict=True))
            # One time for all.
            seen = BicycleState(now.time, *(_array(one, writeable) for one in signals[1:]))
        steer = _array([one[0] for one in ride], writeable)
        steer_rate = _array([one[1] for one in ride], writeable)
        yield np.array(rider.torque(steer, steer_rate, seen))


def _array(values: Sequence[float], writeable: bool) -> Array:
    array = np.array(values)
    array.flags.writeable = writeable
    return array


def _same(first: Sequence[Real] | Array, second: Sequence[Real] | Array, when: str) -> str:
    """Raises where they differ by more than rounding; says whether they are equal to the bit."""
    a, b = np.array(first), np.array(second)
    apart = np.abs(a - b) / np.maximum(1.0, np.abs(a))
    if apart.max() > _ROUNDING:
        step = int(np.argmax((apart if apart.ndim == 1 else apart.max(axis=1)) > _ROUNDING))
        raise _Wrong(f"differs {when}: by {apart[step].max():.2g} N m after {step} steps")
    return "to the bit" if not apart.any() else f"within {_ROUNDING:g} N m"


def _other(value: float) -> float:
    return 1.1 * value if value else 1.0


def _figures_told(figures: dict[str, float]) -> str:
    return ", ".join(f"{key} {value:g}" for key, value in figures.items()) or "no figures"
