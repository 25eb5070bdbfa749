"""Rides until it is killed: `python killed.py FILE COUNTER` counts its ticks in COUNTER."""

import mmap
import sys
from pathlib import Path

from bikesim.model.bicycle import Bicycle
from bikesim.model.whipple import Matrices
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.writer import Provenance, RunHeader, RunWriter


def main(path: Path, counter: Path) -> None:
    zero, one = [[0, 0], [0, 0]], [[1, 0], [0, 1]]
    bicycle = Bicycle("none", "none", Matrices(one, zero, zero, zero), 1, 0, 0)  # pyright: ignore[reportArgumentType]
    header = RunHeader("", bicycle, "off", 1, "", "", None, Provenance.gather())
    with counter.open("r+b") as file, mmap.mmap(file.fileno(), 8) as count:
        # Room for 4 s, so that the kills meet the moves to a larger file too.
        writer = RunWriter(
            path, channels=TICK_CHANNELS, period=1e-3, planned_ticks=4000, header=header
        )
        for tick in range(2_000_000):
            writer.append((tick * 1e-3,) * len(TICK_CHANNELS) + (0.0, 0.0))
            count[:] = (tick + 1).to_bytes(8, "little")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
