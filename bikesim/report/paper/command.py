"""bikesim paper: everything of the reproduction, in order."""

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from bikesim import bicycles
from bikesim.model.law import Law
from bikesim.report.paper.claims import Claim, told
from bikesim.report.paper.figure2 import figure2, figure2_claims
from bikesim.report.paper.figure5 import figure5, figure5_claims, ride_figure5
from bikesim.report.paper.folder import whole_folder
from bikesim.report.paper.identified import identified_claims, ride_identified
from bikesim.report.paper.identified_figure import identified_figure
from bikesim.report.paper.map_claims import map_claims
from bikesim.report.paper.map_figure import map_figure
from bikesim.report.paper.progress import Progress
from bikesim.report.paper.stability_map import Check, StabilityMap, check, over_damping, over_delay
from bikesim.report.paper.table1 import table1
from bikesim.report.style import save
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS, IdentifiedRun


class Effort(NamedTuple):
    """How much is ridden and computed. Times [s]; grids of the maps in SI."""

    ride: float = 30.0
    identified_ride: float = 20.0
    identified: tuple[IdentifiedRun, ...] = IDENTIFIED_RUNS
    delays: tuple[float, ...] = tuple(i / 40 for i in range(17))
    stiffnesses: tuple[float, ...] = tuple(i * 1.25 for i in range(25))
    dampings: tuple[float, ...] = tuple(i * 0.25 for i in range(25))
    check_ride: float = 30.0
    # Every so many columns and rows of the map over delay are ridden.
    check_every: tuple[int, int] = (4, 6)

    @property
    def steps(self) -> int:
        """Of progress."""
        columns = len(self.delays[:: self.check_every[0]])
        rows = len(self.stiffnesses[:: self.check_every[1]])
        return 3 + 2 * len(self.identified) + 2 * len(self.stiffnesses) + 2 * columns * rows


FULL = Effort()


def run_paper(output: Path, *, force: bool, as_json: bool, effort: Effort = FULL) -> int:
    """Reproduce the paper into a folder and print the claims. Raises InputError."""
    with whole_folder(output, force=force) as folder:
        claims = reproduce(folder, effort)
    if as_json:
        print(_json(claims))
    else:
        print(f"{told(claims)}\n\nfigures, records and paper.json in {output}")
    return 0


def reproduce(folder: Path, effort: Effort) -> list[Claim]:
    """All claims; figures, records, the maps' figures and paper.json are written into `folder`."""
    bicycle = bicycles.load("benchmark")
    records = folder / "records"
    with Progress(effort.steps) as progress:
        rides = ride_figure5(records, effort.ride, progress)
        identified = ride_identified(records, effort.identified_ride, progress, effort.identified)
        delays = over_delay(bicycle, effort.delays, effort.stiffnesses, progress)
        dampings = over_damping(bicycle, effort.dampings, effort.stiffnesses, progress)
        checks = _checks(delays, effort, progress)
    drawn = (
        ("figure2", figure2(bicycle)),
        ("figure5", figure5(rides)),
        ("identified-riders", identified_figure(identified)),
        ("stability-map", map_figure(delays, dampings, checks)),
    )
    for name, picture in drawn:
        for suffix in (".png", ".pdf"):
            save(picture, folder / f"{name}{suffix}")
    claims = [
        *table1(bicycle),
        *figure2_claims(bicycle),
        *figure5_claims(rides),
        *identified_claims(identified),
        *map_claims(bicycle, delays, checks),
    ]
    _write_map(folder / "stability-map.csv", (delays, dampings))
    (folder / "paper.json").write_text(_json(claims) + "\n", "utf-8")
    return claims


def _checks(delays: StabilityMap, effort: Effort, progress: Progress) -> list[Check]:
    columns, rows = effort.check_every
    done = []
    for row in delays.cells[::rows]:
        for cell in row[::columns]:
            for law in (Law.PAPER, Law.OFF):
                if (checked := check(cell, law, effort.check_ride)) is not None:
                    done.append(checked)
                progress.step("map, ridden")
    return done


def _write_map(path: Path, maps: Sequence[StabilityMap]) -> None:
    """One row a cell and law: SI units in the names."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            "visual_delay_s arm_damping_N_m_s_rad arm_stiffness_N_m_rad haptics growth_rate_1_s "
            "roll_gain_N_m_rad roll_rate_gain_N_m_s_rad".split()
        )
        for cell in (cell for found in maps for row in found.cells for cell in row):
            given = (
                cell.condition.delay,
                cell.condition.arms.damping,
                cell.condition.arms.stiffness,
            )
            for haptics, rider in (("on", cell.on), ("off", cell.off)):
                writer.writerow([*given, haptics, rider.growth_rate, *rider.gains])


def _json(claims: Sequence[Claim]) -> str:
    return json.dumps([claim.as_json() for claim in claims], indent=2, allow_nan=False)
