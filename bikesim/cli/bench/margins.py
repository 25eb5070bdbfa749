"""bikesim bench margins"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from bikesim.cli.bench.options import BenchName, arg
from bikesim.cli.eig import parse_speeds
from bikesim.cli.output import check_figure
from bikesim.cli.parsing import Flag


@dataclass(frozen=True)
class Margins:
    """How far this bench's loop is from an instability that the bicycle does not have.

    As `bikesim margins`, with the bar, delay, period and coupling of the profile. Nothing is sent.
    """

    bench: BenchName
    bicycle: Annotated[str, arg("NAME|FILE", "By name or file (default: benchmark).")] = "benchmark"
    speeds: Annotated[
        str, arg("SPEEDS", "[m/s]: one (5), several (1,2.5,7), or first:last:step.")
    ] = "1:10:1"
    law: Annotated[str, arg("LAW", "paper, momentum or off (default: paper).")] = "paper"
    gravity: Annotated[float | None, arg("M/S²", "[m/s²] (default: of the bicycle's source).")] = (
        None
    )
    coupling: Annotated[
        float | None, arg("SHARE", "In place of the profile's bar.coupling, 0 to 1.")
    ] = None
    figure: Annotated[
        Path | None,
        arg("FILE", "Where to draw it, .png, .pdf or .svg (default: margins-BENCH.png here)."),
    ] = None
    force: Flag = False
    """Replace a figure that is there already."""
    json: Flag = False
    """Print JSON instead."""

    def __call__(self) -> int:
        from bikesim.bench.bench_loop import bench_loop
        from bikesim.bench.profile import load_bench
        from bikesim.cli.margins import check_share, law_of, load_bicycle, tell_margins
        from bikesim.report.margins_table import margins_table

        if self.coupling is not None:
            check_share(self.coupling)
        speeds, bench = parse_speeds(self.speeds), load_bench(self.bench)
        bicycle, law = load_bicycle(self.bicycle, self.gravity), law_of(self.law)
        loop = bench_loop(bench, bicycle, law, coupling=self.coupling)
        if self.figure is not None:
            check_figure(self.figure, force=self.force)
        table = margins_table(self.bench, bicycle, law, loop, speeds)
        return tell_margins(table, self.figure, force=self.force, json=self.json)
