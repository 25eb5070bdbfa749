"""What is refused before a ride; the emulated drive then never had a torque."""

import math
import struct
import threading
import time
from collections.abc import Callable

import can
import pytest

from bikesim.bench.arm import listen
from bikesim.bench.drives import make_drive
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.steer_node import EmulatedSteerNode
from bikesim.bench.frame import Frame, to_message
from bikesim.bench.parts import make_bar
from bikesim.bench.wheel_course import Wheel
from bikesim.bench.wheel_node import WheelSettings
from bikesim.errors import InputError

from .conftest import Wire
from .lockstep import CIA402, DRIVES, ODRIVE, LockStep, leaning, profile


@pytest.fixture(params=DRIVES)
def bench(request: pytest.FixtureRequest) -> LockStep:
    return LockStep(profile(DRIVES[request.param]), leaning())


def refusal(bench: LockStep) -> str:
    """Of arming: in one line, the drive disabled and without torque all the time."""
    with pytest.raises(InputError) as error:
        bench.arm()
    bench.parts.rig.close()
    assert bench.plant.largest_torque == 0.0
    assert bench.plant.torque == 0.0
    assert "\n" not in str(error.value)
    return str(error.value)


def test_an_armed_drive_is_enabled_without_torque(bench: LockStep):
    bench.arm()
    assert bench.parts.rig.drive_view.enabled
    assert bench.plant.largest_torque == 0.0
    bench.parts.rig.close()
    assert bench.parts.rig.disabled is True


def test_the_emergency_stop_is_open(bench: LockStep):
    bench.plant.node.estop_closed = False
    assert refusal(bench) == "fault 21: the emergency stop is open: close it first"


def test_the_sensor_is_silent(bench: LockStep):
    bench.sim.tamper = lambda frame, time: [] if frame.id == 0x110 else [frame]
    assert refusal(bench).startswith("the sensors do not become ready within 2 s")


def test_the_drive_stays_in_fault():
    bench = LockStep(profile(CIA402), leaning())
    assert isinstance(bench.plant.drive, EmulatedDrive)
    bench.plant.drive.fail(0x3210, 0.0, remains=True)
    said = refusal(bench)
    assert said.startswith("the drive does not become enabled within 2 s: CiA 402 drive 5 is in")
    assert "0x3210" in said


@pytest.mark.parametrize("allowed", [0.1, 0.5])
def test_a_drive_that_measures_a_torque_before_it_is_told_any(allowed: float):
    """Row 25."""
    bench = LockStep(profile(CIA402, thresholds={"rest_torque": allowed}), leaning())

    def torque(frame: Frame, time: float) -> list[Frame]:
        return [frame._replace(data=frame.data[:2] + b"\xc8\0" + frame.data[4:])] if (
            frame.id == 0x185
        ) else [frame]  # fmt: skip

    bench.sim.tamper = torque
    if allowed > 0.42:
        bench.arm()
        bench.parts.rig.close()
        return
    assert refusal(bench).startswith("fault 25: the drive measures +0.42 N m before it is told any")


@pytest.mark.parametrize("command", [0x09, 0x1C], ids=["estimates", "torques"])
def test_an_odrive_sends_what_is_no_number(command: int):
    bench = LockStep(profile(ODRIVE), leaning())

    def spoil(frame: Frame, time: float) -> list[Frame]:
        nan = frame._replace(data=struct.pack("<ff", math.nan, math.nan))
        return [nan if frame.id == 3 << 5 | command else frame]

    bench.sim.tamper = spoil
    assert "no finite numbers: nan, nan" in refusal(bench)


def test_its_own_command_comes_back(bench: LockStep):
    """Row 24: an echo, or another host."""
    command = 0x205 if bench.bench.drive.kind == "cia402" else 3 << 5 | 0x0E
    bench.sim.tamper = lambda frame, time: [frame, Frame(command, bytes(8))]
    assert refusal(bench).startswith("fault 24: a command of this host's own was received")


def test_the_bus_fails(bench: LockStep):
    bench.sim.trouble = "cannot receive: gone"
    assert refusal(bench) == "fault 20: cannot receive: gone"


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda node: setattr(node, "pot", 0.001), "fault 4: potentiometer open or short"),
        (lambda node: setattr(node, "gyro", 0.5 + 1.0 / 10.47), "fault 5: angle sensor 1."),
        (lambda node: setattr(node, "pot", 0.7), "fault 8: steer angle 66.0 deg"),
        (lambda node: setattr(node, "reference_voltage", 2.0), "reference voltage wrong"),
    ],
)
def test_what_would_end_a_ride_is_there_at_rest(
    bench: LockStep, wrong: Callable[[EmulatedSteerNode], None], said: str
):
    wrong(bench.plant.node)
    assert said in refusal(bench)


class TestListening:
    """On a bus, before anything is sent."""

    def heard(
        self,
        wire: Wire,
        *frames: Frame,
        wheel: bool = False,
        error: bool = False,
        node: EmulatedSteerNode | None = None,
        enabling: bool = True,
    ) -> None:
        settings = profile()
        drive = make_drive(settings.drive)
        others = (Wheel(WheelSettings(radius=0.3)),) if wheel else ()
        stop = threading.Event()

        def send() -> None:
            with can.Bus(interface="virtual", channel=wire.name) as theirs:
                while not stop.is_set():
                    for frame in frames:
                        theirs.send(to_message(frame))
                    for frame in () if node is None else node.advance(time.monotonic()):
                        theirs.send(to_message(frame))
                    if error:
                        theirs.send(can.Message(is_error_frame=True, is_extended_id=False))
                    time.sleep(0.01)

        sender = threading.Thread(target=send)
        with wire.host() as ours:
            sender.start()
            try:
                listen(ours, drive, make_bar(settings, drive), others, enabling=enabling)
            finally:
                stop.set()
                sender.join()

    def test_who_is_expected_is_there(self, wire: Wire):
        self.heard(wire, Frame(0x110, bytes(8)), Frame(0x705, b"\x7f"))

    def test_nobody(self, wire: Wire):
        with pytest.raises(InputError, match=r"nobody answers on the bus .* bus\.bitrate"):
            self.heard(wire)

    def test_error_frames_alone(self, wire: Wire):
        with pytest.raises(InputError, match=r"error frames only: is bus\.bitrate right"):
            self.heard(wire, error=True)

    def test_no_sensor_node(self, wire: Wire):
        with pytest.raises(InputError, match="nobody sends 0x110"):
            self.heard(wire, Frame(0x705, b"\x7f"))

    def test_no_wheel(self, wire: Wire):
        with pytest.raises(InputError, match="nobody sends 0x120"):
            self.heard(wire, Frame(0x110, bytes(8)), wheel=True)

    @pytest.mark.parametrize("command", [0x205, 0x080, 0x77F])
    def test_another_host(self, wire: Wire, command: int):
        with pytest.raises(InputError, match=f"fault 24: somebody else sends {command:#05x}"):
            self.heard(wire, Frame(0x110, bytes(8)), Frame(command, bytes(5)))

    def test_the_emergency_stop_is_open_and_the_drive_without_power(self, wire: Wire):
        """Said before the drive is asked, which could not answer; but not where it stays off."""
        node = EmulatedSteerNode()
        node.estop_closed = False
        with pytest.raises(InputError) as error:
            self.heard(wire, node=node)
        assert str(error.value) == "fault 21: the emergency stop is open: close it first"
        self.heard(wire, node=node, enabling=False)

    def test_the_emergency_stop_is_closed(self, wire: Wire):
        self.heard(wire, node=EmulatedSteerNode())
