"""The tick: read the bar, move the bicycle, check the torque, send it, show, record, wait.

The same for one rig, in floats, and for a batch of them, in arrays with a value for each.
"""

from collections.abc import Callable
from time import perf_counter
from typing import NamedTuple, Protocol

from bikesim.guard import Verdict
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.real import Real
from bikesim.record.header import Ending
from bikesim.rig.base import Rig, RigFinished


class Moments(NamedTuple):
    """A disturbance on the bicycle: T_φ and T_δ [N m]."""

    roll: Real = 0.0
    steer: Real = 0.0


class Course(Protocol):
    """What happens to the bicycle from outside, as functions of time [s]."""

    def speed(self, time: float) -> Real:
        """Forward speed [m/s]; the same array each time for as long as a batch's do not change."""
        ...

    def disturbance(self, time: float) -> Moments:
        """What pushes the bicycle."""
        ...


class Haptics(Protocol):
    """What an experiment makes of the feedback torque before it is checked: less, later, none."""

    def __call__(self, time: float, torque: Real, /) -> Real:
        """The torque [N m] to be checked and sent, of that which the law gives at a time [s]."""
        ...


class Checks(Protocol):
    """What lets a torque out, or stops: a guard."""

    def check(self, steer: Real, roll: Real, torque: Real) -> Verdict:
        """For the measured steer angle [rad], the roll [rad] and the torque wanted [N m]."""
        ...


class Recorder(Protocol):
    """Takes one row a tick: TICK_CHANNELS, the rig's own, TIMING_CHANNELS."""

    def append(self, row: tuple[Real, ...]) -> None: ...


class Start(NamedTuple):
    """The bicycle at the first tick: roll [rad], roll rate [rad/s], heading [rad]."""

    roll: Real = 0.0
    roll_rate: Real = 0.0
    heading: Real = 0.0


def as_the_law_gives(time: float, torque: Real) -> Real:
    """Haptics without a change."""
    return torque


def ride(
    rig: Rig,
    haptic: HapticBicycle,
    guard: Checks,
    record: Recorder,
    *,
    course: Course,
    start: Start,
    ticks: int,
    haptics: Haptics = as_the_law_gives,
    interrupted: Callable[[], bool] = lambda: False,
) -> Ending:
    """Ticks until `ticks` are done, the guard stops, the rig has no more, or `interrupted`.

    However it is left, an exception included, the rig is at zero torque and closed. The torque
    recorded as sent is what the rig says it sent; a tick that stops is recorded too.
    """
    began = perf_counter()
    state: BicycleState | None = None
    try:
        for _ in range(ticks):
            tick_began = perf_counter()
            sample = rig.read()
            time, steer, steer_rate = sample
            speed = course.speed(time)
            roll_moment, steer_moment = course.disturbance(time)
            if state is None:
                state = _first(haptic, start, sample, speed, Moments(roll_moment, steer_moment))
            else:
                state = haptic.step(
                    state, time, steer, steer_rate, speed, roll_moment, steer_moment
                )
            wanted = haptics(time, state.feedback_torque)
            allowed, limited, stop = guard.check(steer, state.roll, wanted)
            sent = rig.command(allowed)
            rig.show(state)
            tick_done = perf_counter()
            record.append(
                (
                    time, steer, steer_rate, speed, roll_moment, steer_moment,
                    *state[4:12], allowed, sent, limited,
                    *rig.telemetry(), tick_began - began, tick_done - tick_began,
                )
            )  # fmt: skip
            if stop is not None:
                return Ending(stop.reason, stop.fell, time if stop.fell else None)
            if interrupted():
                return Ending("interrupted")
            rig.wait()
    except RigFinished as finished:
        return Ending(str(finished))
    finally:
        rig.close()
    return Ending("end of run")


def _first(
    haptic: HapticBicycle,
    start: Start,
    sample: tuple[float, Real, Real],
    speed: Real,
    moments: Moments,
) -> BicycleState:
    time, steer, steer_rate = sample
    return haptic.start(
        time=time,
        steer=steer,
        steer_rate=steer_rate,
        speed=speed,
        roll=start.roll,
        roll_rate=start.roll_rate,
        heading=start.heading,
        roll_moment=moments.roll,
        steer_moment=moments.steer,
    )
