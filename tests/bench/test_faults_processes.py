"""Each row of the fault table once on the wall clock: a host process that rides a bench it cannot
see into, over udp_multicast; what the bench, the display and the record then say.

What a row does in which tick is asserted in lock-step (test_faults_*, test_pulse, test_arm). Here
the thresholds have room for a computer that has no time for some tens of milliseconds, and ramping
out (R2) takes so long that nobody can take it for zero at once (R3).

| row | where |
|---|---|
| 1 to 9 | TestSensors |
| 10 to 13, 23 | TestTorque |
| 14 to 17 | TestDrive, both kinds |
| 18 | TestHost: hung, both kinds, and cable out; killed, both kinds: test_processes |
| 19, 20 | TestHost |
| 21 | test_processes |
| 22, 25 | TestRefused |
| 24 | TestRefused before a ride, TestHost in one |
"""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from bikesim.bench.mishaps import Mishap
from bikesim.bench.profile import load_bench

from .hosts import AT, Hang, Host, Ridden, Trick
from .processes import WATCHDOG
from .wall_clock import (
    ROOM,
    Rides,
    let_go_by_itself,
    named,
    ramped_out,
    safe,
    zero_at_once,
    zero_when_seen,
)

pytestmark = [pytest.mark.slow, pytest.mark.real_time]

BOTH = pytest.mark.parametrize("drive", ["cia402-emulated", "odrive-emulated"])


@pytest.fixture(scope="module")
def host() -> Iterator[Host]:
    host = Host()
    yield host
    host.end()


@pytest.fixture
def rides(host: Host, tmp_path: Path) -> Rides:
    return Rides(host, tmp_path)


class TestSensors:
    @pytest.mark.parametrize(
        ("row", "kind", "value", "says"),
        [
            (2, "corrupt", 0.0, r"\d\d sensor frames with a wrong checksum in a row"),
            (3, "repeat", 0.0, r"\d\d sensor frames repeated or frozen in a row"),
            (4, "pot", 0.0, "potentiometer open or short"),
            (7, "jump", 0.1, r"steer angle jumped by \d+\.\d mrad"),
        ],
        ids=["row 2", "row 3", "row 4", "row 7"],
    )
    def test_zero_at_once(self, rides: Rides, row: int, kind: str, value: float, says: str):
        seen = rides.with_mishap(kind, value=value)
        named(seen, row, says)
        zero_at_once(seen)

    def test_row_1_ramped_and_then_zero_at_once(self, rides: Rides):
        seen = rides.with_mishap("drop")
        named(seen, 1, r"no good sensor frame for 4\d\d\.\d ms")
        zero_at_once(seen, after=0.4)

    def test_row_5(self, rides: Rides):
        seen = rides.with_mishap("slip", value=1.0, thresholds={"slip_time": 0.1})
        named(seen, 5, r"angle sensor \d\.\d\d rad/s from the gyro for 100 ms")
        zero_at_once(seen, after=0.15)

    def test_row_6(self, rides: Rides):
        seen = rides.with_mishap("bias", value=-0.4)
        named(seen, 6, r"gyro's angle 0\.05\d rad from the angle sensor's \(bias\)")
        # 0.4 rad/s × 2 s × (1 - exp(-t/2 s)) reaches 0.05 rad after 0.129 s.
        assert -0.02 < ramped_out(seen, 6) - AT - 0.129 < ROOM

    def test_row_8(self, rides: Rides):
        """Somebody pushes it, with 3 N m."""
        seen = rides.with_mishap(
            "push", value=3.0, thresholds={"soft_stop_deg": 15.0, "trip_angle_deg": 20.0}
        )
        named(seen, 8, r"steer angle 2\d\.\d deg")
        zero_when_seen(seen, 8)

    def test_row_9(self, rides: Rides):
        seen = rides.with_mishap("push", value=10.0, thresholds={"trip_rate": 2.0})
        named(seen, 9, r"steer rate [23]\.\d rad/s for 2 ms")
        zero_when_seen(seen, 9)


class TestTorque:
    def test_row_10(self, rides: Rides):
        seen = rides(rides.profile(), trick=Trick("nan"))
        named(seen, 10, r"the law gives nan N m at a roll of .* rad")
        zero_at_once(seen)

    def test_row_11(self, rides: Rides):
        limits = {"torque": 0.2, "continuous_torque": 0.2}
        seen = rides(rides.profile(limits=limits, thresholds={"saturated_time": 0.2}))
        named(seen, 11, r"at the torque limit for 0\.\d\d s")
        assert ramped_out(seen, 11) > 0.19
        assert seen.largest_torque == pytest.approx(0.2, abs=0.003)

    def test_row_12(self, rides: Rides):
        path = rides.profile(limits={"torque_rate": 0.5}, thresholds={"slewed_ticks": 250})
        seen = rides(path)
        named(seen, 12, "the torque's rate limited for 251 ticks in a row")
        assert ramped_out(seen, 12, torque=0.05) > 0.2

    def test_row_13(self, rides: Rides):
        limits = {"torque": 3.5, "continuous_torque": 0.1}
        thresholds = {"thermal_time": 0.2, "cooled_time": 0.1}
        seen = rides(rides.profile(limits=limits, thresholds=thresholds))
        named(seen, 13, r"\d\.\d\d N m RMS over 0\.2 s, scaled down 0\.1 s")
        ramped_out(seen, 13, torque=0.05)

    def test_row_23(self, rides: Rides):
        path = rides.profile(thresholds={"fall_roll_deg": 12.0})
        seen = rides(path, "--set", "start.roll_rate_deg_s=20", trick=Trick())
        assert seen.status == 0, seen.err
        safe(seen)
        run = seen.run()
        assert run.ending is not None
        assert run.ending.fell
        assert run.ending.reason == "fell to the right: roll beyond 12 deg" == seen.words[-1]
        ramped_out(seen, 23)


class TestDrive:
    @BOTH
    def test_row_14(self, rides: Rides, drive: str):
        seen = rides.with_mishap("silence", drive=drive)
        named(seen, 14, r"no (data|heartbeat) of the drive for 4\d\d\.\d ms", answers=False)
        zero_at_once(seen, after=0.4)

    @BOTH
    def test_row_15_state(self, rides: Rides, drive: str):
        seen = rides.with_mishap("disable", drive=drive)
        named(seen, 15, r".* is in (switch on disabled|state 1, not 8).*")
        zero_at_once(seen)

    def test_row_15_mode(self, rides: Rides):
        seen = rides.with_mishap("mode", value=8)
        named(seen, 15, r".* mode 8.*")
        zero_at_once(seen)

    @BOTH
    def test_row_16(self, rides: Rides, drive: str):
        thresholds = {"follow_error": 0.1, "follow_time": 0.1}
        seen = rides.with_mishap("weak", drive=drive, thresholds=thresholds)
        named(seen, 16, r"torque [+-]\d\.\d\d N m from the commanded for 100 ms")
        zero_at_once(seen, after=0.1)

    @BOTH
    def test_row_17(self, rides: Rides, drive: str):
        seen = rides.with_mishap("fail", drive=drive)
        named(seen, 17, r".* reports (error 0x2310|dc bus over current)")
        zero_at_once(seen)


class TestHost:
    @BOTH
    def test_row_18_hung(self, rides: Rides, drive: str):
        """The drive lets go by itself; what it then says is why the ride ends."""
        seen = rides(rides.profile(drive), hang=Hang)
        let_go_by_itself(seen)
        named(seen, 17, ".* reports .*")

    def test_row_18_cable_out(self, rides: Rides):
        # Of all that is silent then, the sensors are to be missed first.
        thresholds = {"zero_age": 0.25, "drive_age": 0.5}
        seen = rides.with_mishap("unplug", thresholds=thresholds)
        let_go_by_itself(seen)
        named(seen, 1, r"no good sensor frame for (2[5-9]|3\d)\d\.\d ms", answers=False)

    def test_row_19(self, rides: Rides):
        """Shorter than the drive's watchdog: what is left of the torque is ramped out."""
        path = rides.profile(thresholds={"late": 0.05, "late_most": 0.05}, watchdog=0.2)
        seen = rides(path, hang=lambda: Hang(0.08))
        named(seen, 19, r"a tick \d+\.\d ms late")
        ramped_out(seen, 19)

    def test_row_20(self, rides: Rides):
        """Nothing can be said any more: the drive's watchdog ends it."""
        seen = rides(rides.profile(), trick=Trick("lose the bus"))
        named(seen, 20, "cannot (send|receive): .*", answers=False)
        zero_at_once(seen, after=WATCHDOG)

    def test_row_24_while_riding(self, rides: Rides):
        seen = rides.with_mishap("master")
        named(seen, 24, "another host commands the drive")
        zero_at_once(seen)


class TestRefused:
    def refused(self, seen: Ridden, row: int, says: str, torque: float = 0.0) -> None:
        """One line, said on the display too; never more than so much torque [N m], and none now."""
        assert seen.status == 2, seen.err
        assert re.fullmatch(rf"bikesim: fault {row}: {says}\n", seen.err), seen.err
        assert seen.words[-1] == seen.err.removeprefix("bikesim: ").strip()
        assert seen.largest_torque <= torque
        assert seen.torques[-1][1] == 0.0
        assert not seen.enabled

    def test_row_22_sign(self, rides: Rides):
        path = rides.profile()
        told = load_bench(str(path))
        drive = told.drive.model_copy(update={"direction": -told.drive.direction})
        seen = rides(path, "--pulse", real=told.model_copy(update={"drive": drive}))
        self.refused(seen, 22, "the bar turns left under a torque to the right .*", 0.303)

    def test_row_22_inertia(self, rides: Rides):
        path = rides.profile()
        told = load_bench(str(path))
        bar = told.bar.model_copy(update={"inertia": 3.0 * told.bar.inertia})
        seen = rides(path, "--pulse", real=told.model_copy(update={"bar": bar}))
        self.refused(seen, 22, r"the bar moves as if its inertia were 0\.\d+ kg m²,.*", 0.303)

    def test_row_24(self, rides: Rides):
        seen = rides(rides.profile(), mishaps=(Mishap(kind="master"),))
        self.refused(seen, 24, "somebody else sends 0x205, which is this host's to send: .*")

    def test_row_25(self, rides: Rides):
        seen = rides(rides.profile(), mishaps=(Mishap(kind="offset", value=0.5),))
        self.refused(seen, 25, r"the drive measures \+0\.50 N m before it is told any; .*")
