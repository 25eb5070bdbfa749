"""bikesim margins"""

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from bikesim.cli.eig import parse_speeds
from bikesim.cli.output import check_figure, print_json, print_table
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError

if TYPE_CHECKING:
    from bikesim.model.bicycle import Bicycle
    from bikesim.model.law import Law
    from bikesim.model.sampled_loop import SampledLoop
    from bikesim.report.margins_table import MarginsTable


def _arg(metavar: str, text: str) -> Any:
    return tyro.conf.arg(metavar=metavar, help=text, help_behavior_hint="")


@dataclass(frozen=True)
class Margins:
    """How far the sampled haptic loop is from an instability that the bicycle does not have.

    At each speed: the delay that it still survives with the bar released, and over grips from
    released to tight how much less stable it is than the continuous loop (allowed: 0.5 1/s).
    """

    bicycle: Annotated[str, _arg("NAME|FILE", "By name or file (default: benchmark).")] = (
        "benchmark"
    )
    speeds: Annotated[
        str, _arg("SPEEDS", "[m/s]: one (5), several (1,2.5,7), or first:last:step.")
    ] = "1:10:1"
    law: Annotated[str, _arg("LAW", "paper, momentum or off (default: paper).")] = "paper"
    rig: Annotated[
        str, _arg("NAME|FILE", "A virtual rig, whose figures those below replace (default: ideal).")
    ] = "ideal"
    inertia: Annotated[
        float | None, _arg("KG·M²", "Of the bar [kg m²] (default: the rig's, or as the law asks).")
    ] = None
    delay: Annotated[
        float | None,
        _arg("S", "From the bar's motion to torque [s], the hold of a period besides."),
    ] = None
    period: Annotated[float, _arg("S", "Of the loop [s] (default: 0.001).")] = 0.001
    filter: Annotated[float | None, _arg("RAD/S", "Low pass on angle and rate, -3 dB [rad/s].")] = (
        None
    )
    filter_order: Annotated[int | None, _arg("N", "Butterworth, 1 to 4.")] = None
    friction: Annotated[float | None, _arg("N·M·S", "Viscous, at the axis [N m s/rad].")] = None
    coupling: Annotated[
        float,
        _arg("SHARE", "Virtual inertia, 0 to 1 of the part of it that the bar lacks (default: 0)."),
    ] = 0.0
    coupling_frequency: Annotated[
        float | None,
        _arg("RAD/S", "Of bar against virtual handle (default: what the delay bears)."),
    ] = None
    gravity: Annotated[float | None, _arg("M/S²", "[m/s²] (default: of the bicycle's source).")] = (
        None
    )
    figure: Annotated[
        Path | None,
        _arg("FILE", "Where to draw it, .png, .pdf or .svg (default: margins-RIG.png here)."),
    ] = None
    force: Flag = False
    """Replace a figure that is there already."""
    json: Flag = False
    """Print JSON instead."""

    def __call__(self) -> int:
        from bikesim.report.margins_table import margins_table

        speeds = parse_speeds(self.speeds)
        bicycle, law = load_bicycle(self.bicycle, self.gravity), law_of(self.law)
        self._check()
        loop = self._loop(bicycle, law)
        if self.figure is not None:
            check_figure(self.figure, force=self.force)
        table = margins_table(self.rig, bicycle, law, loop, speeds)
        return tell_margins(table, self.figure, force=self.force, json=self.json)

    def _check(self) -> None:
        check_share(self.coupling)
        for option, value, least, most, unit in (
            ("--inertia", self.inertia, 1e-4, 100.0, "kg m²"),
            ("--delay", self.delay, 0.0, 1.0, "s"),
            ("--period", self.period, 1e-4, 0.1, "s"),
            ("--filter", self.filter, 0.01, 1e5, "rad/s"),
            ("--filter-order", self.filter_order, 1, 4, ""),
            ("--friction", self.friction, 0.0, 100.0, "N m s/rad"),
            ("--coupling-frequency", self.coupling_frequency, 1.0, 1e4, "rad/s"),
        ):
            if value is not None and not least <= value <= most:
                allowed = f"from {least:g} to {most:g} {unit}".rstrip()
                raise InputError(f"{option} {value}: must be {allowed}")

    def _loop(self, bicycle: "Bicycle", law: "Law") -> "SampledLoop":
        from bikesim.experiment.rig_loop import rig_loop
        from bikesim.model.sampled_loop import with_coupling
        from bikesim.rig.settings import RigSettings

        loop = rig_loop(RigSettings(name=self.rig), bicycle, law, self.period)
        given: dict[str, Any] = {
            "inertia": self.inertia,
            "delay": self.delay,
            "filter_cutoff": self.filter,
            "filter_order": self.filter_order,
            "viscous_friction": self.friction,
        }
        loop = replace(loop, **{key: value for key, value in given.items() if value is not None})
        return with_coupling(loop, self.coupling, bicycle, law, self.coupling_frequency)


def check_share(share: float) -> None:
    """Of a virtual coupling. Raises InputError."""
    if not 0.0 <= share <= 1.0:
        raise InputError(f"--coupling {share}: must be from 0 to 1")


def load_bicycle(name: str, gravity: float | None) -> "Bicycle":
    """By name or file, under another gravity [m/s²] if there is one. Raises InputError."""
    from bikesim import bicycles

    bicycle = bicycles.load(name)
    return bicycle if gravity is None else bicycle.with_gravity(gravity)


def law_of(name: str) -> "Law":
    """A law by its name. Raises InputError."""
    from bikesim.model.law import Law

    if name not in list(Law):
        raise InputError(f"--law {name}: must be one of {', '.join(Law)}")
    return Law(name)


def tell_margins(table: "MarginsTable", figure: Path | None, *, force: bool, json: bool) -> int:
    """Print a table, or JSON, and draw it; the figure that nobody named where it can be."""
    from bikesim.report.margins_table import HEADER

    if figure is not None:
        _draw(table, figure)
    if json:
        print_json(table.as_json())
        return 0
    for line in table.about():
        print(line)
    print()
    print_table(HEADER, table.as_text())
    without = [f"{row.speed:g}" for row in table.rows if not row.is_there]
    print(f"\n{_verdict(without, len(table.rows))}")
    print(f"figure  {figure or _drawn_beside(table, force=force)}")
    return 0


def _verdict(without: list[str], count: int) -> str:
    if not without:
        return "margin at every speed"
    if len(without) == count:
        return "no margin at any of these speeds"
    return f"no margin at {', '.join(without)} m/s"


def _drawn_beside(table: "MarginsTable", *, force: bool) -> str:
    name = re.sub(r"[^\w.+-]+", "-", Path(table.name).stem)
    path = Path(f"margins-{name}.png")
    try:
        check_figure(path, force=force)
        return str(_draw(table, path))
    except InputError as error:
        return f"not drawn: {error}"


def _draw(table: "MarginsTable", path: Path) -> Path:
    from bikesim.report.margins_figure import margins_figure
    from bikesim.report.style import save

    return save(margins_figure(table), path)
