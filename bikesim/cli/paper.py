"""bikesim paper"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from bikesim.cli.parsing import Flag


@dataclass(frozen=True)
class Paper:
    """Reproduce Schwab & Recuero 2013 point by point, and go where it could not.

    Table 1, Figure 2, Figure 5, haptics off; the 15 identified riders of Schwab et al. 2013; and
    the map of what a rider can stabilise over visual delay and arm stiffness. Takes about a minute.
    """

    output: Annotated[Path, tyro.conf.arg(metavar="FOLDER")] = Path("runs/paper")
    """A folder for the figures (PNG and PDF) and paper.json."""
    force: Flag = False
    """Write into a folder that is there already."""
    json: Flag = False
    """Print JSON: one entry a claim."""

    def __call__(self) -> int:
        from bikesim.report.paper.command import run_paper

        return run_paper(self.output, force=self.force, as_json=self.json)
