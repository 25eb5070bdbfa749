"""An experiment of thousands of runs by one command: how long, and how much memory in all.

Target: 10,000 runs of 60 s on 2 cores in less than 25 minutes and 4 GB, also if it is killed on the
way. By default a slice of it, and what that comes to; `python -m benchmarks.study --whole` for all.
The target is for the physics step that ships; `--physics-step 0.001`, which is fine for a bar with
arms on it, takes half as many.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from bikesim.experiment.scenario import Scenario

RUNS, DURATION = 10_000, 60.0
_SLICE_RUNS, _SLICE_DURATION = 1024, 60.0
_SHIPPED = Scenario().physics_step  # [s]
_SCENARIO = """
title = "Throughput"
seeds = {seeds}
scenario.duration = {duration}
scenario.physics_step = {step}
"""


class Cost(NamedTuple):
    """Of a command and all processes that it begins: times [s], largest memory [bytes]."""

    seconds: float
    cpu: float
    memory: int


def main(arguments: Sequence[str] = ()) -> None:
    """Run it and say what it cost."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--whole", action="store_true", help="all of it, not a slice")
    parser.add_argument("--kill", type=float, metavar="S", help="kill it after so long, once")
    parser.add_argument("--physics-step", type=float, default=_SHIPPED, metavar="S", help="[s]")
    options = parser.parse_args(arguments)
    step = options.physics_step
    print(f"  physics step {step * 1e3:g} ms; shipped, and of the target: {_SHIPPED * 1e3:g} ms")
    if options.whole:
        _told("whole", _experiment(RUNS, DURATION, step, options.kill))
    else:
        little = _told("almost none", _experiment(2, 0.1, step, None))
        part = _told("slice", _experiment(_SLICE_RUNS, _SLICE_DURATION, step, options.kill))
        share = _SLICE_RUNS * _SLICE_DURATION / (RUNS * DURATION)
        for what, some, more in (
            ("as busy as this machine is", little.seconds, part.seconds),
            ("with two cores of its own, by CPU time", little.cpu / 2, part.cpu / 2),
        ):
            minutes = (some + (more - some) / share) / 60
            print(f"  {RUNS} runs of {DURATION:g} s, {what}: {minutes:.1f} min")
    print("  target: 25 min, 4 GB, all processes together")


def _told(what: str, cost: Cost) -> Cost:
    print(
        f"  {what}: {cost.seconds:.0f} s, {cost.cpu:.0f} s of CPU, {cost.memory / 1e9:.2f} GB",
        flush=True,
    )
    return cost


def _experiment(runs: int, duration: float, step: float, kill_after: float | None) -> Cost:
    """So many runs in two processes, with the report; begun again if it was killed."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "e.toml"
        path.write_text(_SCENARIO.format(seeds=runs, duration=duration, step=step))
        costs = [] if kill_after is None else [_cost(path, kill_after)]
        costs.append(_cost(path, None))
        rows = len((Path(folder) / "e" / "results.csv").read_text().splitlines()) - 1
    if rows != runs:
        raise SystemExit(f"  {rows} rows in the table, not {runs}")
    seconds, cpu, memory = zip(*costs, strict=True)
    return Cost(sum(seconds), sum(cpu), max(memory))


def _cost(path: Path, kill_after: float | None) -> Cost:
    command = [sys.executable, "-m", "bikesim", "experiment", path, "-o", path.with_suffix("")]
    began, cpu_before, memory = time.monotonic(), _cpu_of_ended(), 0
    process = subprocess.Popen([*command, "--jobs", "2", "--json"], stdout=subprocess.DEVNULL)
    while process.poll() is None:
        memory = max(memory, sum(map(_memory, _family(process.pid))))
        if kill_after is not None and time.monotonic() - began > kill_after:
            process.kill()
        time.sleep(0.2)
    if process.returncode != (0 if kill_after is None else -9):
        raise SystemExit(f"  the command ended with status {process.returncode}")
    return Cost(time.monotonic() - began, _cpu_of_ended() - cpu_before, memory)


def _cpu_of_ended() -> float:
    """Of all processes that have ended here, and of those that they waited for [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _family(pid: int) -> list[int]:
    """A process and all that it has begun."""
    found = [pid]
    for one in found:
        for tasks in Path(f"/proc/{one}/task").glob("*/children"):
            found += _numbers(tasks)
    return found


def _numbers(path: Path) -> list[int]:
    try:
        return [int(text) for text in path.read_text().split()]
    except OSError:
        return []  # it has just ended


def _memory(pid: int) -> int:
    """Of a process [bytes]; what it shares with others is divided among them."""
    try:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) * 1024 for line in lines if line.startswith("Pss:")), 0)


if __name__ == "__main__":
    main(sys.argv[1:])
