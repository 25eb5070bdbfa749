from pathlib import Path

import pytest

from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario
from bikesim.record.reader import Run, open_run


@pytest.fixture(scope="session")
def ridden(tmp_path_factory: pytest.TempPathFactory):
    """The record of a short scenario with these keys."""
    folder: Path = tmp_path_factory.mktemp("ridden")

    def ride(name: str, **keys) -> Run:
        path = folder / f"{name}.h5"
        run(build(Scenario(**{"duration": 0.5, "start": {"roll_deg": 2}, **keys})), path)
        return open_run(path)

    return ride


@pytest.fixture(scope="session")
def upright(ridden) -> Run:
    return ridden("upright")


@pytest.fixture(scope="session")
def fallen(ridden) -> Run:
    return ridden("fallen", law="off", rider="hands-off", duration=5)
