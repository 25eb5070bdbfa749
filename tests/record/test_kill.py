"""kill -9 of real processes, at random moments."""

import os
import random
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import bikesim
from bikesim.record.reader import Run, open_run

RIDE = Path(__file__).with_name("killed.py")


def ride_and_kill(path: Path, after: float) -> int:
    """Kill a process that rides so many seconds after its file is there; the ticks it had done."""
    counter = path.with_suffix(".count")
    counter.write_bytes(bytes(8))
    environment = {**os.environ, "PYTHONPATH": str(Path(bikesim.__file__).parents[1])}
    process = subprocess.Popen([sys.executable, str(RIDE), path, counter], env=environment)
    try:
        deadline = time.monotonic() + 30
        while not path.exists():
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.001)
        time.sleep(after)
        assert process.poll() is None, "it ended before it was killed"
    finally:
        process.kill()
        process.wait()
    return int.from_bytes(counter.read_bytes(), "little")


def whole(run: Run) -> bool:
    return all(np.array_equal(run.channel(name), run.time) for name in run.names)


@pytest.mark.parametrize("seed", range(10))
def test_a_killed_run_opens_and_lacks_less_than_a_second(tmp_path: Path, seed: int):
    path = tmp_path / "run.h5"
    ticks = ride_and_kill(path, after=random.Random(seed).uniform(0, 0.4))
    run = open_run(path)
    assert not run.complete
    assert whole(run)
    assert (ticks - run.ticks) * run.period < 1
