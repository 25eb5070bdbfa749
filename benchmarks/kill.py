"""kill -9 at random moments: how much of a run does its record lack?

Each ride is `python -m bikesim run` in a process of its own, which also counts its ticks in memory
shared with this one: what it had really done when it was killed.
"""

import argparse
import mmap
import random
import runpy
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bikesim.errors import InputError
from bikesim.record.reader import open_run
from bikesim.record.writer import RunWriter

ALLOWED = 1.0  # [s] of the run that a record may lack


@dataclass(frozen=True)
class Kill:
    """A killed ride: ticks done and recorded; `fault` says what is wrong with the record."""

    done: int
    recorded: int
    lacks: float
    fault: str | None


def main(arguments: Sequence[str] = ()) -> None:
    """Kill so many rides and print the worst; SystemExit if a record is not as it must be."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--duration", type=float, default=60.0, help="of a ride [s]")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    moments = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        riding = _time_riding(Path(folder) / "whole.h5", options.duration)
        kills: list[Kill] = []
        while len(kills) < options.kills:
            path = Path(folder) / f"{len(kills)}.h5"
            kill = _kill(path, options.duration, moments.uniform(0, riding))
            path.unlink(missing_ok=True)
            if kill is not None:
                kills.append(kill)
    _report(kills)


def _report(kills: list[Kill]) -> None:
    faults = [kill.fault for kill in kills if kill.fault is not None]
    lacks = [kill.lacks for kill in kills if kill.fault is None]
    opened = f"{len(kills)} kills, {len(lacks)} records open and whole"
    print(f"{opened}; lacking at most {max(lacks, default=0):.3f} s (allowed: {ALLOWED} s)")
    for fault in faults:
        print(f"  {fault}")
    if faults or max(lacks, default=0) >= ALLOWED:
        raise SystemExit(1)


def _time_riding(path: Path, duration: float) -> float:
    """Wall time from the record being there to the end of a whole ride [s]."""
    ride = _start(path, duration)
    begun = _wait_for(path, ride)
    if ride.wait() != 0:
        raise SystemExit(f"the ride ended with status {ride.returncode}")
    return time.monotonic() - begun


def _kill(path: Path, duration: float, after: float) -> Kill | None:
    """A ride killed so long after its record is there [s]; None if it was at its end by then."""
    ride = _start(path, duration)
    try:
        _wait_for(path, ride)
        time.sleep(after)
    finally:
        ride.kill()
    if ride.wait() == 0:
        return None
    done = int.from_bytes(path.with_suffix(".count").read_bytes(), "little")
    try:
        run = open_run(path)
    except InputError as error:
        return Kill(done, 0, 0, str(error))
    whole = all(np.isfinite(run.channel(name)).all() for name in run.names)
    fault = None if whole else f"{path}: a channel has gaps"
    return Kill(done, run.ticks, (done - run.ticks) * run.period, fault)


def _start(path: Path, duration: float) -> subprocess.Popen[bytes]:
    counter = path.with_suffix(".count")
    counter.write_bytes(bytes(8))
    command = [sys.executable, "-m", "benchmarks.kill", "ride", counter, path, str(duration)]
    with path.with_suffix(".log").open("wb") as log:
        return subprocess.Popen(command, cwd=Path(__file__).parents[1], stdout=log, stderr=log)


def _wait_for(path: Path, ride: subprocess.Popen[bytes]) -> float:
    """When the record was there, on the monotonic clock."""
    while not path.exists():
        if ride.poll() is not None:
            told = path.with_suffix(".log").read_text()
            raise SystemExit(f"the ride ended before its record began:\n{told}")
        time.sleep(0.001)
    return time.monotonic()


def _ride(counter: Path, path: str, duration: str) -> None:
    """`bikesim run`, with each tick counted where the killing process can see it."""
    append = RunWriter.append
    with counter.open("r+b") as file:
        count = mmap.mmap(file.fileno(), 8)

    def counted(writer: RunWriter, row: tuple[float, ...]) -> None:
        append(writer, row)
        count[:] = writer.ticks.to_bytes(8, "little")

    RunWriter.append = counted  # type: ignore[method-assign]
    sys.argv = ["bikesim", "run", "--duration", duration, "--output", path]
    runpy.run_module("bikesim", run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["ride"]:
        _ride(Path(sys.argv[2]), *sys.argv[3:])
    else:
        main(sys.argv[1:])
