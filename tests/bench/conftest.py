"""A bus in this process, and the drives that the tests use."""

from collections.abc import Iterator
from contextlib import contextmanager

import can
import pytest
from canopen.sdo.base import SdoBase, SdoVariable

from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.emulated.device import Device
from bikesim.bench.emulated.pump import Pump, PumpThread
from bikesim.bench.odrive_settings import ODriveSettings

from .lockstep import DRIVES, LockStep, leaning, profile


class Wire:
    """A virtual bus with a name of its own."""

    def __init__(self, name: str) -> None:
        self.name = name

    @contextmanager
    def host(self) -> Iterator[can.BusABC]:
        with can.ThreadSafeBus(interface="virtual", channel=self.name) as bus:
            yield bus

    @contextmanager
    def with_devices(self, *devices: Device) -> Iterator[can.BusABC]:
        """The host's bus, on which emulated devices live in a thread."""
        with (
            can.Bus(interface="virtual", channel=self.name) as theirs,
            self.host() as ours,
            PumpThread(Pump(theirs, devices)),
        ):
            yield ours


def variable(sdo: SdoBase, index: int, subindex: int = 0) -> SdoVariable:
    """An object as canopen reaches it."""
    found = sdo.get_variable(index, subindex)
    assert found is not None
    return found


@pytest.fixture
def wire(request: pytest.FixtureRequest) -> Wire:
    return Wire(request.node.nodeid)


@pytest.fixture
def drive() -> Cia402Settings:
    """The motor of the 2013 rig, on a drive that has its rated torque in uN m."""
    return Cia402Settings(
        node=5,
        rated_torque=0.386,
        torque_unit="uNm",
        gear=5.5,
        encoder_counts=4096,
        torque_limit=3.5,
    )


@pytest.fixture
def odrive() -> ODriveSettings:
    return ODriveSettings(
        node=3, torque_constant=0.055, gear=4.0, torque_limit=3.0, heartbeat_period=0.01
    )


@pytest.fixture(params=DRIVES)
def bench(request: pytest.FixtureRequest) -> LockStep:
    """In lock-step, with each kind of drive."""
    return LockStep(profile(DRIVES[request.param], thresholds={"ramp_in": 0.05}), leaning())
