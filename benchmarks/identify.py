"""Whether identified gains are the true ones, and their intervals honest.

Run 184 of Schwab et al. 2013 on the Davis bicycle: a roll multisine of 12 lines and 5 N m RMS for
90 s, a remnant of 0.3 N m. Target: the truth inside the 95 % interval in at least 9 of 10 runs for
each gain, least squares beside it, biased.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from bikesim.experiment.disturbances import Disturbance
from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario
from bikesim.identify.answer import Identification, Question, TorqueSource
from bikesim.identify.ride import read_ride
from bikesim.identify.rider import identify_rider
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS
from bikesim.rider.settings import RiderSettings

_RUN = next(run for run in IDENTIFIED_RUNS if run.run == 184)
_TRUE = np.array([_RUN.roll, _RUN.roll_rate, _RUN.steer_integral, _RUN.steer_rate])
# What is known of such runs: SCIENCE, Section 4, without saying which lines.
_KNOWN_BIASED = (11.3, 21.8, 50.5, -2.5)


def main(arguments: Sequence[str] = ()) -> None:
    """Prints a row a gain, over runs with seeds 1, 2, …."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--torque", choices=("rider", "bar"), default="rider")
    options = parser.parse_args(arguments)
    with ProcessPoolExecutor(os.cpu_count()) as crew:
        identified = partial(_identified, torque=options.torque)
        found = list(crew.map(identified, range(1, options.seeds + 1)))
    _print_table(found)
    explained = np.mean([one.vaf for one in found])
    print(f"  explained (VAF): {explained:.1f} %; warnings: {sum(len(o.warnings) for o in found)}")


def _print_table(found: list[Identification]) -> None:
    values, errors, biased = (
        np.array([[getattr(gain, name) for gain in one.gains] for one in found])
        for name in ("value", "standard_error", "least_squares")
    )
    inside = np.array([[g.low <= t <= g.high for g, t in _pairs(one)] for one in found])
    print("  gain             true     mean   spread    error    inside       LS")
    for i, gain in enumerate(found[0].gains):
        counted = f"{inside[:, i].sum()} of {len(found)}"
        print(
            f"  {gain.name:12} {_TRUE[i]:8.2f} {values[:, i].mean():8.2f} "
            f"{values[:, i].std(ddof=1):8.2f} {errors[:, i].mean():8.2f} {counted:>9} "
            f"{biased[:, i].mean():8.2f}"
        )
    print(
        "  spread: of the runs; error: what their intervals are made of; LS: least squares, mean "
        f"(one set of lines is known to give {_KNOWN_BIASED})"
    )


def _pairs(one: Identification):
    return zip(one.gains, _TRUE.tolist(), strict=True)


def _identified(seed: int, torque: TorqueSource) -> Identification:
    scenario = Scenario(
        bicycle="davis",
        speed=_RUN.speed,
        rider=RiderSettings(name="schwab2013-184", remnant_rms=0.3),
        disturbances=(Disturbance(kind="roll-multisine", lines=12, torque_rms=5.0),),
        duration=90,
        seed=seed,
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.h5"
        run(build(scenario), path)
        return identify_rider([read_ride(path)], Question(torque=torque))


if __name__ == "__main__":
    main(sys.argv[1:])
