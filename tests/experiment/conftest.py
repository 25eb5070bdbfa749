from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bikesim.experiment.history import SIGNALS, History
from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario
from bikesim.record.header import Ending
from bikesim.record.reader import Run, open_run


@pytest.fixture
def ridden(tmp_path: Path) -> Callable[..., Run]:
    """The record of a scenario with these keys, of 0.3 s unless they say otherwise."""

    def ride(name: str = "run.h5", **keys) -> Run:
        run(build(Scenario(**{"duration": 0.3, **keys})), tmp_path / name)
        return open_run(tmp_path / name)

    return ride


@pytest.fixture
def made_up() -> Callable[..., History]:
    """A ride at rest but for these signals: numbers, arrays or functions of time; 20 s at 100 Hz,
    ticks at 1 kHz.
    """

    def make(seconds: float = 20.0, *, period: float = 0.01, **given: Any) -> History:
        ending = given.pop("ending", Ending("end of run"))
        time = period * np.arange(round(seconds / period))
        signals = {name: np.zeros(len(time)) for name in SIGNALS}
        for name, value in {"time": time, **given}.items():
            values: Any = value(time) if callable(value) else value
            signals[name] = np.array(np.broadcast_to(values, time.shape), float)
        return History(
            period=period,
            every=10,
            ticks=10 * len(time),
            ending=ending,
            planned_duration=seconds,
            **signals,
        )

    return make
