"""Rows 14 to 18: the drive. A tick is 1 ms.

Row 18 with real processes is in test_processes and test_slcan.
"""

import pytest

from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.odrive import EmulatedODrive
from bikesim.bench.odrive import AxisError

from .faulted import (
    AT,
    fault_of,
    near,
    ridden,
    silent,
    zeroed_at_once,
)
from .lockstep import LockStep, leaning, profile


def test_row_14_silent(bench: LockStep):
    ids = bench.drive.ids
    after = fault_of(bench, silent(bench, ids), 14)
    # After 5 ms; the encoder frames of an ODrive come each ms, the status with each SYNC.
    assert after == near(6)
    assert zeroed_at_once(bench)


def test_row_14_heartbeat_gone(bench: LockStep):
    beat = 0x705 if bench.bench.drive.kind == "cia402" else 3 << 5 | 1
    after = fault_of(bench, silent(bench, {beat}), 14)
    assert 0.005 <= after <= 0.0165
    assert zeroed_at_once(bench)


def test_row_15_wrong_state(bench: LockStep):
    device = bench.plant.drive

    def disable(since: float) -> None:
        if isinstance(device, EmulatedDrive):
            device._power.disable()
        else:
            assert isinstance(device, EmulatedODrive)
            device._request(1)

    after = fault_of(bench, ridden(bench, disable), 15)
    assert after <= (0.0025 if bench.bench.drive.kind == "cia402" else 0.0115)


def test_row_15_wrong_mode():
    bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning())
    device = bench.plant.drive
    assert isinstance(device, EmulatedDrive)
    ending = ridden(bench, lambda since: device.objects.set(0x6061, 0, 8))
    # The frame that says so, or the torque that is missing: whichever is first.
    assert fault_of(bench, ending, 15) <= 0.0025
    assert "mode 8" in ending.reason


def test_row_16_torque_not_followed():
    bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning(start={"roll_deg": 13.0}))
    device = bench.plant.drive
    assert isinstance(device, EmulatedDrive)
    ending = ridden(bench, lambda since: device.objects.set(0x6072, 0, 0))
    assert fault_of(bench, ending, 16) == near(21)
    assert zeroed_at_once(bench)


def test_row_17_error(bench: LockStep):
    device = bench.plant.drive

    def fail(since: float) -> None:
        if isinstance(device, EmulatedDrive):
            device.fail(0x2310, bench.sim._devices_began + bench.sim.now)
        else:
            assert isinstance(device, EmulatedODrive)
            device.fail(AxisError.DC_BUS_OVER_CURRENT)

    ending = ridden(bench, fail)
    after = fault_of(bench, ending, 17)
    assert after <= (0.0025 if bench.bench.drive.kind == "cia402" else 0.0115)
    assert ("0x2310" if bench.bench.drive.kind == "cia402" else "over current") in ending.reason


def test_row_18_the_host_is_gone(bench: LockStep):
    """Hung, killed, cut off: the drive disables itself, whatever torque it had."""
    ride = bench.prepared()
    bench.arm()

    class Gone(Exception):
        pass

    def gone(time: float, torque: float) -> float:
        if time > AT:
            raise Gone
        return torque

    ride._haptics = gone
    began = bench.sim.now
    bench.sim.tamper_host = lambda frame, time: [frame] if time < began + AT else []
    torque: list[float] = []
    advance = bench.plant.advance

    def advanced() -> None:
        torque.append(bench.plant.torque)
        advance()

    bench.plant.advance = advanced
    with pytest.raises(Gone):
        ride.go()
    while bench.sim.now < began + AT + 0.1:
        bench.sim._advance()
    alone = torque[round(AT / 0.001) :]
    assert abs(alone[0]) > 0.1
    # 30 ms from the last heartbeat or torque command; a heartbeat comes each 7.5 ms.
    assert 21 <= sum(one != 0.0 for one in alone) <= 31
    assert alone[-1] == 0.0
