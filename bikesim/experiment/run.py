"""One run: a scenario becomes bicycle, rider, rig and loop, and leaves a record."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bikesim import bicycles
from bikesim.experiment.course import ScenarioCourse
from bikesim.experiment.scenario import Scenario, to_toml
from bikesim.experiment.torque_record import with_file_digest, with_recorded_torque
from bikesim.guard import Guard
from bikesim.haptics import make_haptics
from bikesim.loop import Haptics, Start, ride
from bikesim.model.bicycle import Bicycle
from bikesim.model.eigen import bicycle_modes, simulator_modes
from bikesim.model.haptic import HapticBicycle
from bikesim.model.law import Law
from bikesim.model.real import Real
from bikesim.model.simulator import handlebar_inertia
from bikesim.path.building import make_path
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import Ending, RunHeader
from bikesim.record.provenance import Provenance
from bikesim.record.writer import RunWriter
from bikesim.rider.base import Setting
from bikesim.rider.building import make_rider
from bikesim.rig.virtual import VirtualRig


@dataclass(frozen=True)
class Parts:
    """What a scenario is made of when it is ready to run."""

    scenario: Scenario
    bicycle: Bicycle
    haptic: HapticBicycle
    rig: VirtualRig
    guard: Guard
    course: ScenarioCourse
    start: Start
    haptics: Haptics


def scenario_bicycle(scenario: Scenario) -> Bicycle:
    """The scenario's bicycle under its gravity. Raises InputError."""
    bicycle = bicycles.load(scenario.bicycle)
    return bicycle if scenario.gravity is None else bicycle.with_gravity(scenario.gravity)


def rig_inertia(scenario: Scenario, bicycle: Bicycle) -> float:
    """I_δ [kg m²] of the scenario's rig without arms: as it says, else as its law asks."""
    return scenario.rig.inertia or handlebar_inertia(bicycle, Law(scenario.law))


def make_setting(scenario: Scenario, bicycle: Bicycle, speed: Real) -> Setting:
    """What a scenario's rider knows of where he rides; `speed` [m/s] at the start."""
    preview = scenario.vision.preview
    return Setting(
        bicycle=bicycle,
        law=Law(scenario.law),
        inertia=rig_inertia(scenario, bicycle),
        speed=speed,
        step=scenario.physics_step,
        path=make_path(scenario.path),
        preview=math.inf if preview is None else preview,
    )


def sources(scenario: Scenario) -> tuple[np.random.Generator, np.random.Generator]:
    """The noise of a run, from its seed: the rider's, and the sensors'."""
    for_rider, for_sensors = np.random.SeedSequence(scenario.seed).spawn(2)
    return np.random.default_rng(for_rider), np.random.default_rng(for_sensors)


def build(scenario: Scenario) -> Parts:
    """Everything of a run but its record. Raises InputError."""
    scenario = scenario.model_copy(update={"rider": with_file_digest(scenario.rider)})
    bicycle = scenario_bicycle(scenario)
    course = ScenarioCourse(scenario, bicycle)
    for_rider, for_sensors = sources(scenario)
    rider = make_rider(
        with_recorded_torque(scenario.rider),
        make_setting(scenario, bicycle, course.speed(0.0)),
        scenario.vision,
        for_rider,
    )
    rig = VirtualRig(
        scenario.rig,
        rider,
        name=scenario.rig.name,
        inertia=rig_inertia(scenario, bicycle),
        steer_axis_tilt=bicycle.steer_axis_tilt,
        period=scenario.period,
        step=scenario.physics_step,
        random=for_sensors,
        steer=math.radians(scenario.start.steer_deg),
    )
    return Parts(
        scenario,
        bicycle,
        HapticBicycle(bicycle, Law(scenario.law)),
        rig,
        Guard(scenario.guard, scenario.period, scenario.rig.steer_stop),
        course,
        Start(
            math.radians(scenario.start.roll_deg),
            math.radians(scenario.start.roll_rate_deg_s),
            math.radians(scenario.start.heading_deg),
        ),
        make_haptics(scenario.haptics, scenario.period),
    )


def run(
    parts: Parts,
    output: Path,
    *,
    force: bool = False,
    interrupted: Callable[[], bool] = lambda: False,
) -> Ending:
    """Ride the scenario to its end and record it in `output`. Raises InputError."""
    scenario, info = parts.scenario, parts.rig.info
    header = RunHeader(
        scenario=to_toml(scenario),
        bicycle=parts.bicycle,
        law=scenario.law,
        handlebar_inertia=info.inertia,
        rig=info.name,
        rider=scenario.rider.name,
        seed=scenario.seed,
        provenance=Provenance.gather(),
    )
    try:
        with RunWriter(
            output,
            channels=(*TICK_CHANNELS, *info.channels),
            period=info.period,
            planned_ticks=scenario.ticks,
            header=header,
            force=force,
        ) as record:
            ending = ride_parts(parts, record, interrupted)
            record.finish(ending)
    finally:
        # Also where the record could not be opened, and the loop never began.
        parts.rig.close()
    return ending


def ride_parts(parts: Parts, record, interrupted: Callable[[], bool] = lambda: False) -> Ending:
    """Ride without saying where the ticks go: `record` takes them by `append`."""
    return ride(
        parts.rig,
        parts.haptic,
        parts.guard,
        record,
        course=parts.course,
        start=parts.start,
        ticks=parts.scenario.ticks,
        haptics=parts.haptics,
        interrupted=interrupted,
    )


class InertiaError(NamedTuple):
    """What a rig of another inertia than the law asks for does to the modes, hands off."""

    inertia: float
    wanted: float
    speed: float
    eigenvalue_error: float
    mode: str


def inertia_error(parts: Parts) -> InertiaError | None:
    """The eigenvalue error [1/s] that the rig's own inertia causes; None where it is as asked."""
    law = Law(parts.scenario.law)
    inertia, wanted = parts.rig.info.inertia, handlebar_inertia(parts.bicycle, law)
    if law is Law.OFF or math.isclose(inertia, wanted, rel_tol=1e-3):
        return None
    speed = parts.course.speed(0.0)
    is_, should = (
        simulator_modes(parts.bicycle, law, speed, inertia),
        bicycle_modes(parts.bicycle, speed),
    )
    errors = {
        "castering": abs(is_.castering - should.castering),
        "capsize": abs(is_.capsize - should.capsize),
        "weave": abs(is_.weave[0] - should.weave[0]),
    }
    mode = max(errors, key=errors.__getitem__)
    return InertiaError(inertia, wanted, speed, errors[mode], mode)
