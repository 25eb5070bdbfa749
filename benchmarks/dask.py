"""How much faster two workers of a Dask cluster are than one. Target: 1.7 times."""

import statistics
import tempfile
import time
from pathlib import Path

from bikesim.experiment.study.conduct import ride_batches
from bikesim.experiment.study.dask_crew import DaskCrew
from bikesim.experiment.study.folder import open_folder
from bikesim.experiment.study.plan import Study, make_study
from bikesim.experiment.study.reading import parse_experiment

_ROUNDS = 3
_EXPERIMENT = "seeds = {seeds}\nscenario.duration = 4.0\n"
_BATCH = 256


def main() -> None:
    """One worker and two in turn, several times; the ratio of each pair, and its median."""
    study, warm = _study(1024), _study(8)
    ratios = []
    for i in range(_ROUNDS):
        one, two = (_seconds(study, warm, workers) for workers in (1, 2))
        ratios.append(one / two)
        print(f"  round {i + 1}: one worker {one:.1f} s, two {two:.1f} s, {one / two:.2f} x")
    print(f"  median {statistics.median(ratios):.2f} x (target: 1.7 x)")


def _study(seeds: int) -> Study:
    return make_study(parse_experiment(_EXPERIMENT.format(seeds=seeds), None))


def _seconds(study: Study, warm: Study, workers: int) -> float:
    """From the first batch to the last row; the cluster is there and has imported all it needs."""
    with DaskCrew(workers=workers) as crew, tempfile.TemporaryDirectory() as folder:
        _ride(warm, Path(folder) / "warm", crew, 1)
        began = time.perf_counter()
        _ride(study, Path(folder) / "results", crew, _BATCH)
        return time.perf_counter() - began


def _ride(study: Study, path: Path, crew: DaskCrew, size: int) -> None:
    with open_folder(path, study, force=False) as folder:
        batches = study.batches(set(), size, workers=2)
        assert ride_batches(study, batches, folder, crew, lambda: False).whole


if __name__ == "__main__":
    main()
