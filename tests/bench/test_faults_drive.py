"""Rows 14 to 18: the drive. A tick is 1 ms.

Row 18 with real processes is in test_processes and test_slcan.
"""

import math
import struct

import pytest

from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.odrive import EmulatedODrive
from bikesim.bench.frame import Frame
from bikesim.bench.odrive import AxisError

from .faulted import (
    AT,
    fault_of,
    near,
    ridden,
    silent,
    tampered,
    without,
    zeroed_at_once,
)
from .lockstep import DRIVES, ODRIVE, LockStep, leaning, profile


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


@pytest.mark.parametrize(
    ("kind", "identifier"),
    [("cia402", 0x185), ("cia402", 0x285), ("odrive", 3 << 5 | 0x09), ("odrive", 3 << 5 | 0x1C)],
    ids=["status", "motion", "estimates", "torques"],
)
@pytest.mark.parametrize("source", ["node", "drive"])
def test_row_14_one_of_its_messages_gone(kind: str, identifier: int, source: str):
    """All others come: each has an age of its own."""
    bar = {"inertia": 0.2311, "source": source}
    bench = LockStep(profile(DRIVES[kind], bar=bar, thresholds={"ramp_in": 0.05}), leaning())
    bench.answers = identifier != 0x185
    ending = tampered(bench, without(identifier))
    assert fault_of(bench, ending, 14) == near(6)
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


def test_row_16_an_odrive_does_not_follow():
    bench = LockStep(
        profile(ODRIVE, thresholds={"ramp_in": 0.05}), leaning(start={"roll_deg": 13.0})
    )
    device = bench.plant.drive
    assert isinstance(device, EmulatedODrive)
    ending = ridden(bench, lambda since: setattr(device, "_current_limit", 0.0))
    # Its torque comes each 2 ms.
    assert fault_of(bench, ending, 16) == near(22)
    assert zeroed_at_once(bench)


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


@pytest.mark.parametrize(
    ("command", "what"), [(0x09, "encoder"), (0x1C, "torque")], ids=["estimates", "torques"]
)
@pytest.mark.parametrize("place", [0, 4])
@pytest.mark.parametrize("figure", [math.nan, math.inf])
def test_row_17_an_odrive_sends_what_is_no_number(
    command: int, what: str, place: int, figure: float
):
    bench = LockStep(profile(ODRIVE, thresholds={"ramp_in": 0.05}), leaning())

    def spoil(frame: Frame) -> list[Frame]:
        if frame.id != 3 << 5 | command:
            return [frame]
        data = frame.data[:place] + struct.pack("<f", figure) + frame.data[place + 4 :]
        return [frame._replace(data=data)]

    ending = tampered(bench, spoil)
    assert fault_of(bench, ending, 17) == near(1)
    assert f"sends {what} estimates that are no finite numbers" in ending.reason
    assert zeroed_at_once(bench)
    assert all(map(math.isfinite, bench.rows.channel("motor_torque")))


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
