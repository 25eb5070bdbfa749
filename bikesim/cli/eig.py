"""bikesim eig"""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from bikesim.cli.output import check_figure, print_json, print_table
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError

if TYPE_CHECKING:
    from bikesim.report.eigenvalue_table import EigenvalueTable

_MOST_SPEEDS = 100_000


@dataclass(frozen=True)
class Eig:
    """Eigenvalues over speed: the bicycle, and its simulator under both laws, hands off.

    Each with the handlebar inertia that the law asks for. Prints a table and draws the figure.
    """

    bicycle: Annotated[str, tyro.conf.arg(metavar="NAME|FILE")] = "benchmark"
    """A bicycle by name, or the path of its file; frame+rider joins two files."""
    speeds: Annotated[str, tyro.conf.arg(metavar="SPEEDS")] = "0:10:1"
    """Forward speeds [m/s]: one (5), several (1,2.5,7), or first:last:step (0:10:0.1)."""
    gravity: Annotated[
        float | None,
        tyro.conf.arg(
            metavar="M/S²", help="[m/s²] (default: of the bicycle's source).", help_behavior_hint=""
        ),
    ] = None
    inertia: Annotated[
        float | None,
        tyro.conf.arg(
            metavar="KG·M²",
            help="Of the rig's handlebar [kg m²] (default: what each law asks for).",
            help_behavior_hint="",
        ),
    ] = None
    figure: Annotated[
        Path | None,
        tyro.conf.arg(
            metavar="FILE",
            help="Where to draw it, .png, .pdf or .svg (default: eigenvalues-BICYCLE.png here).",
            help_behavior_hint="",
        ),
    ] = None
    force: Flag = False
    """Replace a figure that is there already."""
    json: Flag = False
    """Print JSON instead; its lists are castering, capsize, weave, weave as [re, im] in 1/s."""

    def __call__(self) -> int:
        from bikesim import bicycles
        from bikesim.report.eigenvalue_table import eigenvalue_table

        speeds = parse_speeds(self.speeds)
        bicycle = bicycles.load(self.bicycle)
        if self.gravity is not None:
            bicycle = bicycle.with_gravity(self.gravity)
        if self.inertia is not None and not 0 < self.inertia < 1e3:
            raise InputError(f"--inertia {self.inertia}: must be above 0 and below 1000 kg m²")
        if self.figure is not None:
            check_figure(self.figure, force=self.force)
        table = eigenvalue_table(bicycle, speeds, self.inertia)
        if self.json:
            if self.figure is not None:
                self._draw(table, self.figure)
            print_json(table.as_json())
            return 0
        if self.figure is not None:
            self._draw(table, self.figure)
        self._tell(table)
        print(f"\nfigure  {self.figure or self._draw_beside(table)}")
        return 0

    def _draw_beside(self, table: "EigenvalueTable") -> str:
        """The figure that nobody named: made where it can be, the table is there all the same."""
        name = re.sub(r"[^\w.+-]+", "-", Path(table.bicycle.name).name).removesuffix(".txt")
        path = Path(f"eigenvalues-{name}.png")
        try:
            check_figure(path, force=self.force)
            return str(self._draw(table, path))
        except InputError as error:
            return f"not drawn: {error}"

    def _tell(self, table: "EigenvalueTable") -> None:
        print(f"{table.bicycle.name}: {table.bicycle.source}\n")
        header = ["v [m/s]", "", "castering", "capsize", "weave"]
        print_table(header, table.as_text())
        print(
            f"\nself-stable from {_speed(table.limits.weave)} (weave) to "
            f"{_speed(table.limits.capsize)} (capsize); handlebar inertia asked for: "
            f"paper {table.inertia_paper:.6g}, momentum {table.inertia_momentum:.6g} kg m²"
        )

    def _draw(self, table: "EigenvalueTable", path: Path) -> Path:
        from bikesim.report.eigenvalue_figure import eigenvalue_figure
        from bikesim.report.style import save

        save(eigenvalue_figure(table), path)
        return path


def parse_speeds(text: str) -> list[float]:
    """ "5", "1,2.5" or "first:last:step", last included, in m/s. Raises InputError."""
    wrong = InputError(
        f"--speeds {text}: must be a speed (5), several (1,2.5) or first:last:step (0:10:0.1), "
        "from 0 to 100 m/s"
    )
    try:
        if ":" in text:
            first, last, step = (float(part) for part in text.split(":"))
            if not (step > 0 and last >= first) or (last - first) / step > _MOST_SPEEDS:
                raise wrong
            count = int((last - first) / step + 1e-9) + 1
            speeds = [round(first + i * step, 12) for i in range(count)]
        else:
            speeds = [float(part) for part in text.split(",")]
    except (ValueError, OverflowError):
        raise wrong from None
    if not all(0 <= speed <= 100 for speed in speeds):
        raise wrong
    return speeds


def _speed(value: float | None) -> str:
    return "no speed" if value is None else f"{value:.4f} m/s"
