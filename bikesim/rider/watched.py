"""A rider of the user's own under watch: what goes wrong is said in one line, with the time."""

import math
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn, TypeGuard

import numpy as np

from bikesim.errors import InputError
from bikesim.model.real import Real
from bikesim.rider.base import Brain, Sight
from bikesim.rider.figures import each_of

_OURS = Path(__file__).resolve().parents[1]


@contextmanager
def refused(name: str, when: str) -> Iterator[None]:
    """Makes an InputError of whatever a user's rider raises."""
    try:
        yield
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        _refuse(name, error, when)


class _Watch:
    """Asks a brain at every `step` [s]."""

    def __init__(self, name: str, brain: Brain, step: float) -> None:
        self._name, self._brain_intends, self._step = name, brain.intend, step
        self._steps = -1

    def _asked(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        self._steps += 1
        try:
            return self._brain_intends(steer, steer_rate, seen)
        except InputError:
            raise
        except (Exception, SystemExit) as error:
            _refuse(self._name, error, self._when())

    def _wrong(self, what: str, must: str) -> InputError:
        return InputError(f"rider {self._name} gave {what} {self._when()}: must be {must}")

    def _when(self) -> str:
        return f"at {self._steps * self._step:.4f} s"


class Watched(_Watch):
    """A brain whose torque must be one finite number."""

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """What the brain intends. Raises InputError."""
        torque = self._asked(steer, steer_rate, seen)
        if type(torque) is float and -math.inf < torque < math.inf:
            return torque
        if not _is_number(torque) or not math.isfinite(torque):
            raise self._wrong(_told(torque), "a finite number")
        return float(torque)


class WatchedMany(_Watch):
    """A brain of a batch of `riders`, whose torques must be an array (n,) of finite numbers."""

    def __init__(self, name: str, brain: Brain, step: float, riders: int) -> None:
        super().__init__(name, brain, step)
        self._shape = (riders,)

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """What the brain intends; one number is that of all. Raises InputError."""
        torque = self._asked(steer, steer_rate, seen)
        must = f"an array of shape {self._shape} of finite numbers"
        if _is_number(torque):
            torque = np.full(self._shape, float(torque))
        elif not _is_array(torque) or torque.shape != self._shape:
            raise self._wrong(_told(torque), must)
        # A copy: the brain may write into what it gave.
        torques = torque.astype(float)
        if not np.isfinite(torques).all():
            first = int(np.argmin(np.isfinite(torques)))
            what = f"{torques[first]:g} for rider {first + 1} of {self._shape[0]}"
            raise self._wrong(what, must)
        return torques


class OneByOne:
    """A batch of brains that each know floats only."""

    def __init__(self, brains: Sequence[Brain]) -> None:
        self._intend = [brain.intend for brain in brains]

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """What each intends, of what he feels and sees."""
        count = len(self._intend)
        sights = map(Sight, *(each_of(count, signal) for signal in seen))
        each = zip(self._intend, steer.tolist(), steer_rate.tolist(), sights, strict=True)
        return np.array([intend(angle, rate, sight) for intend, angle, rate, sight in each])


def _refuse(name: str, error: BaseException, when: str) -> NoReturn:
    said = " ".join(str(error).split())
    text = f"rider {name} raised {type(error).__name__} {when}{_line(error)}"
    raise InputError(f"{text}: {said}" if said else text) from error


def _line(error: BaseException) -> str:
    """The line of the user's file that it came from, where that is known."""
    if isinstance(error, SyntaxError):
        return ""  # it says so itself
    frames = traceback.extract_tb(error.__traceback__)
    theirs = [f for f in frames if Path(f.filename).is_file() and not _is_ours(f.filename)]
    lines = [f.lineno for f in theirs if f.filename == theirs[0].filename]
    return f" ({Path(theirs[0].filename).name}, line {lines[-1]})" if lines else ""


def _is_ours(file: str) -> bool:
    return Path(file).is_relative_to(_OURS)


def _is_number(value: object) -> bool:
    if _is_array(value):
        return not value.shape  # of floats np.where makes an array without dimensions
    return isinstance(value, float | int | np.floating | np.integer) and not isinstance(value, bool)


def _is_array(value: object) -> TypeGuard[np.ndarray]:
    return isinstance(value, np.ndarray) and value.dtype.kind in "fiu"


def _told(value: object) -> str:
    if isinstance(value, np.ndarray):
        if value.shape:
            return f"an array of shape {value.shape}"
        value = value.item()
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
