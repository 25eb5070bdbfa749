"""bikesim export"""

from dataclasses import dataclass
from pathlib import Path

import tyro


@dataclass(frozen=True)
class Export:
    """Write a record for other programs: CSV, Parquet or MATLAB, by the suffix of the output."""

    record: tyro.conf.Positional[Path]
    """A run file."""
    output: tyro.conf.Positional[Path]
    """The file to write: .csv, .parquet or .mat."""
    force: bool = False
    """Replace a file that is there already."""

    def __call__(self) -> int:
        from bikesim.record.export import export_run
        from bikesim.record.reader import open_run

        run = open_run(self.record)
        print(f"{export_run(run, self.output, force=self.force)}: {run.ticks} ticks")
        return 0
