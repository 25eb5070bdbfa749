"""Short rides to film, and what films them."""

from collections.abc import Callable
from pathlib import Path

import av
import numpy as np
import pytest

from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario, StartSettings
from bikesim.record.reader import Run, open_run
from bikesim.view.gl import Backend, find_backend
from bikesim.view.quality import Quality
from bikesim.view.video import Look

# The bench is the quickest to build; one second at 10 Hz is the shortest that shows anything.
SMALL = Look(view="bench", width=320, height=180, quality=Quality.DRAFT)


@pytest.fixture(scope="session")
def backend() -> Backend:
    return find_backend()


@pytest.fixture
def look() -> Look:
    return SMALL


def ridden(folder: Path, scenario: Scenario) -> Run:
    run(build(scenario), folder / "run.h5")
    return open_run(folder / "run.h5")


@pytest.fixture(scope="session")
def upright(tmp_path_factory) -> Run:
    """One second, law paper, leaning 5 degrees at first: ticks 0 to 0.999 s."""
    start = StartSettings(roll_deg=5)
    return ridden(tmp_path_factory.mktemp("upright"), Scenario(duration=1, start=start))


@pytest.fixture(scope="session")
def fallen(tmp_path_factory) -> Run:
    """Haptics off, and lost from the beginning."""
    start = StartSettings(roll_deg=30, roll_rate_deg_s=20)
    scenario = Scenario(duration=5, law="off", start=start)
    return ridden(tmp_path_factory.mktemp("fallen"), scenario)


@pytest.fixture
def decoded() -> Callable[[Path], list[np.ndarray]]:
    """The frames of a video as RGB."""

    def decode(path: Path) -> list[np.ndarray]:
        with av.open(str(path)) as container:
            return [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]

    return decode
