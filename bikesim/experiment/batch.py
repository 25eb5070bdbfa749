"""Many runs at once: the same loop, with arrays in place of floats."""

import json
import math
from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.batch_guard import BatchGuard
from bikesim.experiment.batch_history import BatchHistory
from bikesim.experiment.course import BatchCourse
from bikesim.experiment.history import History
from bikesim.experiment.run import make_setting, rig_inertia, scenario_bicycle, sources
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.torque_record import with_file_digest, with_recorded_torque
from bikesim.haptics import make_haptics
from bikesim.loop import Start, ride
from bikesim.model.bicycle import Bicycle
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law
from bikesim.model.real import Real
from bikesim.record.header import Ending
from bikesim.rider.building import make_riders
from bikesim.rig.batch import BatchRig, Riding

# What may differ between the runs of one batch: these keys, and the figures of the rider.
_OWN = {"seed", "start", "speed", "pushes", "disturbances", "rider"}


class Outcome(NamedTuple):
    """How a run of a batch ended, and its signals."""

    ending: Ending
    history: History


def batch_key(scenario: Scenario) -> Hashable:
    """Equal for scenarios that can ride in one batch."""
    shared = scenario.model_dump(mode="json", exclude=_OWN)
    rider = scenario.rider.model_dump(mode="json")
    # An absent figure is another rider than one of any size; those of a rider of the user's own
    # have defaults.
    fixed = {k: v for k, v in rider.items() if k != "figures" and not _is_number(v)}
    return json.dumps([shared, fixed], sort_keys=True)


def ride_batch(
    scenarios: Sequence[Scenario], interrupted: Callable[[], bool] = lambda: False
) -> list[Outcome]:
    """Rides scenarios of one `batch_key` together; each as it would ride alone.

    Asked at every tick, `interrupted` ends them all. Raises InputError.
    """
    first, rigs = scenarios[0], len(scenarios)
    with_file_digest(first.rider)  # one torque for all: it is that of the settings
    bicycle, law = scenario_bicycle(first), Law(first.law)
    course = BatchCourse(scenarios, bicycle)
    riding = Riding(rigs)
    for_riders, for_sensors = zip(*(sources(one) for one in scenarios), strict=True)
    rider = make_riders(
        [with_recorded_torque(one.rider) for one in scenarios],
        make_setting(first, bicycle, course.speed(0.0)),
        [one.vision for one in scenarios],
        for_riders,
    )
    rig = BatchRig(
        first.rig,
        rider,
        riding,
        name=first.rig.name,
        inertia=rig_inertia(first, bicycle),
        steer_axis_tilt=bicycle.steer_axis_tilt,
        period=first.period,
        step=first.physics_step,
        randoms=for_sensors,
        steer=_radians(one.start.steer_deg for one in scenarios),
    )
    guard = BatchGuard(first.guard, first.period, first.rig.steer_stop, riding)
    kept = BatchHistory(rigs, first.period, first.ticks)
    count = _Count(interrupted)
    # A wild rig's figures may overflow in the tick in which the guard ends it.
    with np.errstate(all="ignore"):
        ending = ride(
            rig,
            _Bicycles(bicycle, law, riding),
            guard,
            kept,
            course=course,
            start=_starts(scenarios),
            ticks=first.ticks,
            haptics=make_haptics(first.haptics, first.period),
            interrupted=count,
        )
    ticks = count.ticks if ending.reason == "interrupted" else first.ticks
    return [_outcome(kept, rig, stop, ending, ticks, first) for rig, stop in enumerate(guard.stops)]


class _Bicycles(HapticBicycle):
    """Those that ride; the others are put at rest, lest they fall for ever and overflow."""

    def __init__(self, bicycle: Bicycle, law: Law, riding: Riding) -> None:
        super().__init__(bicycle, law)
        self._riding, self._left = riding, riding.count
        self._steps = 0

    def step(
        self,
        before: BicycleState,
        time: Real,
        steer: Real,
        steer_rate: Real,
        speed: Real,
        roll_moment: Real = 0.0,
        steer_moment: Real = 0.0,
    ) -> BicycleState:
        state = super().step(before, time, steer, steer_rate, speed, roll_moment, steer_moment)
        self._steps += 1
        if self._riding.count < self._left or (
            self._riding.ids is not None and self._steps % _REST_AGAIN == 0
        ):
            self._left = self._riding.count
            resting = [np.where(self._riding.mask, value, 0.0) for value in state[4:]]
            return BicycleState(*state[:4], *resting)
        return state


_REST_AGAIN = 1000


class _Count:
    """Counts the ticks on its way to being asked whether to stop."""

    def __init__(self, interrupted: Callable[[], bool]) -> None:
        self.ticks, self._interrupted = 0, interrupted

    def __call__(self) -> bool:
        self.ticks += 1
        return self._interrupted()


def _starts(scenarios: Sequence[Scenario]) -> Start:
    return Start(
        _radians(one.start.roll_deg for one in scenarios),
        _radians(one.start.roll_rate_deg_s for one in scenarios),
        _radians(one.start.heading_deg for one in scenarios),
    )


def _radians(degrees: Iterable[float]) -> NDArray[np.float64]:
    return np.array([math.radians(one) for one in degrees])


def _outcome(
    kept: BatchHistory, rig: int, stopped: Any, ending: Ending, ticks: int, scenario: Scenario
) -> Outcome:
    if stopped is not None:
        stop, tick = stopped
        ticks = tick + 1
        ending = Ending(stop.reason, stop.fell, tick * scenario.period if stop.fell else None)
    elif ending.reason != "interrupted":
        ending = Ending("end of run")
    return Outcome(ending, kept.history(rig, ending, ticks))


def _is_number(value: object) -> bool:
    return isinstance(value, float | int) and not isinstance(value, bool)
