"""A small run to record: what each tick holds can be told from its number."""

import contextlib
import math
import resource
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import pytest

from bikesim.model.bicycle import Bicycle
from bikesim.model.parameters import BicycleParameters
from bikesim.record.channels import TICK_CHANNELS, Channel
from bikesim.record.writer import Provenance, RunHeader, RunWriter

PERIOD = 0.01
CHANNELS = (*TICK_CHANNELS, Channel("rider_torque", "N m", "> 0 turns right", "of the rider"))


@pytest.fixture
def bicycle() -> Bicycle:
    """The benchmark bicycle [M07, Table 1]."""
    parameters = BicycleParameters(
        w=1.02, c=0.08, lam=math.pi / 10, rR=0.3, mR=2, IRxx=0.0603, IRyy=0.12,
        xB=0.3, zB=-0.9, mB=85, IBxx=9.2, IByy=11, IBzz=2.8, IBxz=2.4,
        xH=0.9, zH=-0.7, mH=4, IHxx=0.05892, IHyy=0.06, IHzz=0.00708, IHxz=-0.00756,
        rF=0.35, mF=3, IFxx=0.1405, IFyy=0.28,
    )  # fmt: skip
    return Bicycle.from_parameters(parameters, name="benchmark", source="[M07, Table 1]")


@pytest.fixture
def header(bicycle: Bicycle) -> RunHeader:
    return RunHeader(
        scenario="speed = 3.5  # m/s, φ",
        bicycle=bicycle,
        law="paper",
        handlebar_inertia=0.23108501173,
        rig="virtual",
        rider="pd",
        seed=7,
        provenance=Provenance.gather(),
    )


class NumberedRun(RunWriter):
    """Tick k holds k in its second channel, k + 1 in the third, and so on."""

    def row(self, tick: int, wall_time: float = 0.0) -> tuple[float, ...]:
        values = (float(tick + i) for i in range(len(CHANNELS) - 1))
        return (tick * PERIOD, *values, wall_time, 1e-5 * tick)

    def ride(self, ticks: int) -> None:
        for tick in range(self.ticks, self.ticks + ticks):
            self.append(self.row(tick))


@pytest.fixture
def channels() -> tuple[Channel, ...]:
    return CHANNELS


@pytest.fixture
def record(tmp_path: Path, header: RunHeader) -> Callable[..., NumberedRun]:
    """Begins a run in a file: `record(planned_ticks, name="run.h5", force=False)`."""

    def begin(planned: int | None, name: str = "run.h5", force: bool = False) -> NumberedRun:
        return NumberedRun(
            tmp_path / name,
            channels=CHANNELS,
            period=PERIOD,
            planned_ticks=planned,
            header=header,
            force=force,
        )

    return begin


@pytest.fixture
def file_size_limit() -> Callable[[int], AbstractContextManager[None]]:
    """The system refuses to let any file grow beyond so many bytes, as a disk that is full."""

    @contextlib.contextmanager
    def limit(size: int) -> Iterator[None]:
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)

    return limit
