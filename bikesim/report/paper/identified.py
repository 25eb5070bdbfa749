"""What the paper could not show: the 15 riders identified in [S13], with haptics on and off."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from bikesim import bicycles
from bikesim.experiment.scenario import LawName, Scenario, StartSettings
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.record.reader import Run
from bikesim.report.paper.claims import Claim
from bikesim.report.paper.progress import Progress
from bikesim.report.paper.riding import fell, recorded
from bikesim.rider.linear import closed_loop, linear_rider, spectral_abscissa
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS, IdentifiedRun
from bikesim.rider.settings import RiderSettings

BICYCLE = "davis"  # on which all were identified


class Growth(NamedTuple):
    """Growth rates [1/s] of a rider: on the bicycle, with haptics on (law paper), and off."""

    bicycle: float
    on: float
    off: float


class IdentifiedRide(NamedTuple):
    """An identified run: its growth rates by linear analysis, its two rides in the virtual rig."""

    run: IdentifiedRun
    growth: Growth
    on: Run
    off: Run


def growth(bicycle: Bicycle, run: IdentifiedRun) -> Growth:
    """The growth rates of a run's rider on a bicycle at the run's speed."""
    rider = linear_rider(_rider(run))
    return Growth(
        *(
            spectral_abscissa(closed_loop(bicycle, run.speed, rider, law=law))
            for law in (None, Law.PAPER, Law.OFF)
        )
    )


def ride_identified(
    records: Path,
    duration: float,
    progress: Progress,
    runs: Sequence[IdentifiedRun] = IDENTIFIED_RUNS,
) -> list[IdentifiedRide]:
    """Ride each from a roll of 1 degree for `duration` [s], with haptics on and off."""
    bicycle = bicycles.load(BICYCLE)
    rides = []
    for run in sorted(runs, key=lambda run: run.speed):
        on = _ride(run, "paper", records, duration, progress)
        off = _ride(run, "off", records, duration, progress)
        rides.append(IdentifiedRide(run, growth(bicycle, run), on, off))
    return rides


def _ride(
    run: IdentifiedRun, law: LawName, records: Path, duration: float, progress: Progress
) -> Run:
    scenario = Scenario(
        bicycle=BICYCLE,
        speed=run.speed,
        law=law,
        rider=_rider(run),
        start=StartSettings(roll_deg=1.0),
        duration=duration,
    )
    haptics = "off" if law == "off" else "on"
    ride = recorded(scenario, records / f"schwab2013-{run.run}-{haptics}.h5")
    progress.step("identified riders")
    return ride


def _rider(run: IdentifiedRun) -> RiderSettings:
    return RiderSettings(name=f"schwab2013-{run.run}")


def identified_claims(rides: Sequence[IdentifiedRide]) -> list[Claim]:
    """The headline again, for all identified riders: linear analysis, then the virtual rig."""
    count = len(rides)
    stable = sum(ride.growth.on < 0 for ride in rides)
    unstable = sum(ride.growth.off > 0 for ride in rides)
    up = sum(not fell(ride.on) for ride in rides)
    down = sum(fell(ride.off) for ride in rides)
    return [
        Claim(
            f"{count} identified riders [S13], haptics on: stable",
            None,
            f"{stable} of {count}, {_range(ride.growth.on for ride in rides)} 1/s",
            stable == count,
            "Linear analysis, each on the Davis bicycle and at the speed it was identified at. On "
            f"the bicycle itself: {_range(ride.growth.bicycle for ride in rides)} 1/s.",
        ),
        Claim(
            f"{count} identified riders, haptics off: unstable",
            None,
            f"{unstable} of {count}, {_range(ride.growth.off for ride in rides)} 1/s",
            unstable == count,
            "Linear analysis; the growth rate of the most unstable mode.",
        ),
        Claim(
            f"{count} identified riders in the virtual rig, haptics on: stay up",
            None,
            f"{up} of {count}",
            up == count,
            f"For {rides[0].on.ticks * rides[0].on.period:.0f} s from 1 deg of roll.",
        ),
        Claim(
            f"{count} identified riders in the virtual rig, haptics off: fall",
            None,
            f"{down} of {count}",
            down == count,
            _falls(rides),
        ),
    ]


def _range(values: Iterable[float]) -> str:
    ordered = sorted(values)
    return f"{ordered[0]:+.2f} to {ordered[-1]:+.2f}"


def _falls(rides: Sequence[IdentifiedRide]) -> str:
    endings = [ride.off.ending for ride in rides if ride.off.ending is not None]
    times = sorted(ending.fall_time for ending in endings if ending.fall_time is not None)
    if not times:
        return ""
    at_stop = sum("stop" in ending.reason for ending in endings)
    return (
        f"After {times[0]:.2f} to {times[-1]:.2f} s: {at_stop} with the bar at its stop, "
        f"{len(times) - at_stop} by rolling beyond the guard's limit."
    )
