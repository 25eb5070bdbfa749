"""bikesim plot"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from bikesim.cli.output import check_apart, check_figure
from bikesim.cli.parsing import Flag


@dataclass(frozen=True)
class Plot:
    """Draw records: roll, steer, torques and path over time; several runs on the same axes."""

    records: Annotated[
        tuple[Path, ...],
        tyro.conf.Positional,
        tyro.conf.arg(
            metavar="RUN.h5 [RUN.h5 ...]", help="Run files, one or more.", help_behavior_hint=""
        ),
    ]
    output: Annotated[
        Path | None,
        tyro.conf.arg(
            aliases=["-o"],
            metavar="FILE",
            help="The figure, .png, .pdf or .svg (default: the first record's name with .png).",
            help_behavior_hint="",
        ),
    ] = None
    force: Flag = False
    """Replace a figure that is there already."""

    def __call__(self) -> int:
        from bikesim.errors import InputError
        from bikesim.record.reader import open_run
        from bikesim.report.run_figure import run_figure
        from bikesim.report.style import save

        if not self.records:
            raise InputError("RUN.h5 is missing (bikesim plot --help)")
        path = self.output or self.records[0].with_suffix(".png")
        check_apart(path, *self.records)
        check_figure(path, force=self.force)
        save(run_figure([open_run(record) for record in self.records]), path)
        print(f"figure  {path}")
        return 0
