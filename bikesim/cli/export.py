"""bikesim export"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from bikesim.cli.output import check_apart
from bikesim.cli.parsing import Flag


@dataclass(frozen=True)
class Export:
    """Write a record for other programs: CSV, Parquet or MATLAB, by the suffix of the output."""

    record: Annotated[
        Path,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="RUN.h5", help="A run file.", help_behavior_hint=""),
    ]
    output: Annotated[
        Path,
        tyro.conf.Positional,
        tyro.conf.arg(
            metavar="OUTPUT",
            help="The file to write: .csv, .parquet or .mat.",
            help_behavior_hint="",
        ),
    ]
    force: Flag = False
    """Replace a file that is there already."""

    def __call__(self) -> int:
        from bikesim.record.export import export_run
        from bikesim.record.reader import open_run

        check_apart(self.output, self.record)
        run = open_run(self.record)
        print(f"{export_run(run, self.output, force=self.force)}: {run.ticks} ticks")
        return 0
