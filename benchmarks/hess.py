"""Hess's riders: crossovers of their loops by bicycle and speed, who stays up, a lane change."""

import math
from collections.abc import Sequence

import numpy as np

from bikesim import bicycles
from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import LawName, Scenario
from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.path.building import make_path
from bikesim.path.settings import PathSettings
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import Ending
from bikesim.rider.hess_gains import published_gains, published_speeds
from bikesim.rider.hess_loops import Crossovers, crossovers, handling_quality, linear_hess
from bikesim.rider.linear import closed_loop, spectral_abscissa
from bikesim.rider.settings import RiderSettings

_OUTER = np.array([2.0, 1.0, 0.5])  # rad/s: roll, heading, lateral [H12]
_TOLD = (3.2, 3.6, 4.0, 4.8, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0)
_FINE = 200
_OTHERS = ("browser", "pista", "rigid-early", "rigid", "davis")
_FREQUENCIES = np.linspace(0.01, 40.0, 400)
_NAMES = [channel.name for channel in TICK_CHANNELS]


class _Rows:
    def __init__(self) -> None:
        self.rows: list[tuple[float, ...]] = []

    def append(self, row: tuple[float, ...]) -> None:
        self.rows.append(row)

    def column(self, name: str) -> np.ndarray:
        return np.array([row[_NAMES.index(name)] for row in self.rows])


def main() -> None:
    """Prints the tables, each figure with its target."""
    benchmark = bicycles.load("benchmark")
    print("  benchmark      crossover [rad/s]                      growth [1/s] of the closed loop")
    print("  m/s      steer   roll  heading  lateral   peak HQM   bicycle  haptics on      off")
    for speed in _TOLD:
        _tell_speed(benchmark, speed)
    worst = 100 * _largest_error(benchmark)
    print(f"  outer three, {_FINE} speeds from 3.2 to 12 m/s: at most {worst:.2f} % (target: 5 %)")
    print("  from 2, 1 and 0.5 rad/s")
    for name in _OTHERS:
        bicycle = bicycles.load(name)
        least, most = published_speeds(bicycle)
        worst = 100 * _largest_error(bicycle)
        print(f"  {name}: {least:g} to {most:g} m/s: at most {worst:.1f} % from the same")
    _tell_lane_change("paper", "at most 0.1 m, no fall")
    _tell_lane_change("off", "falls")


def _tell_speed(bicycle: Bicycle, speed: float) -> None:
    gains = published_gains(bicycle, speed)
    found = crossovers(bicycle, gains, speed)
    peak = handling_quality(bicycle, gains, speed, _FREQUENCIES).max()
    rider = linear_hess(bicycle, gains, speed)
    growth = [
        spectral_abscissa(closed_loop(bicycle, speed, rider, law=law))
        for law in (None, Law.PAPER, Law.OFF)
    ]
    loops = f"{found.steer:6.2f}  {found.roll:5.3f}  {found.heading:7.3f}  {found.lateral:7.3f}"
    growing = f"{growth[0]:7.2f}  {growth[1]:10.2f}  {growth[2]:7.2f}"
    print(f"  {speed:4.1f}    {loops}   {peak:8.2f}   {growing}")


def _largest_error(bicycle: Bicycle) -> float:
    """Of the outer three, relative."""
    speeds = np.linspace(*published_speeds(bicycle), _FINE).tolist()
    return max(_error(crossovers(bicycle, published_gains(bicycle, v), v)) for v in speeds)


def _error(found: Crossovers) -> float:
    return float(np.abs(np.array(found[2:]) / _OUTER - 1).max())


def _tell_lane_change(law: LawName, target: str) -> None:
    path = PathSettings(kind="lane-change")
    rider = RiderSettings(name="hess2012")
    rows = _Rows()
    ending = ride_parts(
        build(Scenario(rider=rider, path=path, speed=5.0, duration=13.0, law=law)), rows
    )
    deviation = _deviations(path, rows.column("x").tolist(), rows.column("y").tolist())
    print(
        f"  lane change of {path.offset:g} m within {path.length:g} m at 5 m/s, law {law}: "
        f"{_told(ending)}, rear contact {np.sqrt(np.mean(deviation**2)):.3f} m RMS from the path, "
        f"at most {np.abs(deviation).max():.3f} m (target: {target})"
    )


def _deviations(settings: PathSettings, x: Sequence[float], y: Sequence[float]) -> np.ndarray:
    path, near, deviations = make_path(settings), 0.0, []
    for point in zip(x, y, strict=True):
        place = path.place(*point, near)
        near = place.station
        deviations.append(place.deviation)
    return np.array(deviations)


def _told(ending: Ending) -> str:
    when = math.nan if ending.fall_time is None else ending.fall_time
    return f"fell at {when:.2f} s" if ending.fell else "stayed up"


if __name__ == "__main__":
    main()
