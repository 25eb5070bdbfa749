from collections.abc import Callable
from pathlib import Path

import pytest

from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario
from bikesim.record.reader import Run, open_run


@pytest.fixture
def ridden(tmp_path: Path) -> Callable[..., Run]:
    """The record of a scenario with these keys, of 0.3 s unless they say otherwise."""

    def ride(name: str = "run.h5", **keys) -> Run:
        run(build(Scenario(**{"duration": 0.3, **keys})), tmp_path / name)
        return open_run(tmp_path / name)

    return ride
