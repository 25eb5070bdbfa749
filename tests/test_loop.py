import math
from collections.abc import Callable

import pytest

from bikesim import bicycles
from bikesim.guard import Guard, GuardSettings, Verdict
from bikesim.loop import Moments, Start, ride
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law
from bikesim.record.channels import TICK_CHANNELS, TIMING_CHANNELS, Channel
from bikesim.record.header import Ending
from bikesim.rig.base import RigFinished, RigInfo, Sample

PERIOD = 1e-3
COLUMN = {channel.name: i for i, channel in enumerate(TICK_CHANNELS)}


class Rig:
    """Notes every call; sends half of what it is asked to; may fail in any method."""

    info = RigInfo(
        "notes", PERIOD, 0.23, 1.0, (Channel("extra", "1", "none", "the tick's number"),)
    )

    def __init__(
        self, calls: list[str], fails: str = "", error: BaseException | None = None
    ) -> None:
        self.calls, self._fails, self._error = calls, fails, error
        self.sent, self.closed, self.ticks = 0.0, 0, 0
        self.samples: Callable[[int], Sample] = lambda k: Sample(k * PERIOD, 0.001 * k, 0.01)
        self.shown: list[BicycleState] = []

    def _note(self, call: str) -> None:
        self.calls.append(call)
        if call == self._fails and self._error is not None and self.ticks == 2:
            raise self._error

    def read(self) -> Sample:
        self._note("read")
        return self.samples(self.ticks)

    def command(self, torque: float) -> float:
        self._note("command")
        self.sent = 0.5 * torque
        return self.sent

    def show(self, bicycle: BicycleState) -> None:
        self._note("show")
        self.shown.append(bicycle)

    def telemetry(self) -> tuple[float, ...]:
        self._note("telemetry")
        return (float(self.ticks),)

    def wait(self) -> None:
        self._note("wait")
        self.ticks += 1

    def close(self) -> None:
        self.calls.append("close")
        self.closed += 1
        self.sent = 0.0


class Course:
    def __init__(self, speed: float = 4.0, moments: Moments | None = None) -> None:
        self._speed, self._moments = speed, moments or Moments()

    def speed(self, time: float) -> float:
        return self._speed

    def disturbance(self, time: float) -> Moments:
        return self._moments


class Rows:
    """A record in memory."""

    def __init__(self) -> None:
        self.rows: list[tuple[float, ...]] = []

    def append(self, row: tuple[float, ...]) -> None:
        self.rows.append(row)

    def column(self, name: str) -> list[float]:
        return [row[COLUMN[name]] for row in self.rows]


class Ridden(Rows):
    """A ride with parts that note what is done to them; it is its own record."""

    def __init__(self, fails: str = "", error: BaseException | None = None, **rides) -> None:
        super().__init__()
        self.calls: list[str] = []
        self.rig = Rig(self.calls, fails, error)
        self._fails, self._error = fails, error
        self._rides: dict = {"ticks": 4, "course": Course(), "start": Start(roll=0.01), **rides}

    def ride(self, law: Law = Law.PAPER, **changed) -> Ending:
        haptic = HapticBicycle(bicycles.load("benchmark"), law)
        guard = Guard(GuardSettings(torque_rate_limit=1e6), PERIOD, 1.0)
        check, step = guard.check, haptic.step

        def checked(steer: float, roll: float, torque: float) -> Verdict:
            self._note("check")
            return check(steer, roll, torque)

        def stepped(*arguments) -> BicycleState:
            self._note("step")
            return step(*arguments)

        setattr(haptic, "step", stepped)  # noqa: B010
        setattr(guard, "check", checked)  # noqa: B010
        return ride(self.rig, haptic, guard, self, **{**self._rides, **changed})

    def append(self, row: tuple[float, ...]) -> None:
        self._note("append")
        super().append(row)

    def _note(self, call: str) -> None:
        self.calls.append(call)
        if call == self._fails and self._error is not None and self.rig.ticks == 2:
            raise self._error


TICK = ["read", "step", "check", "command", "show", "telemetry", "append", "wait"]


class TestOrder:
    def test_of_a_tick_is_the_houses(self):
        ridden = Ridden()
        ridden.ride(ticks=3)
        assert ridden.calls == [*TICK, *TICK, *TICK, "close"]

    def test_a_run_has_as_many_ticks_as_asked(self):
        ridden = Ridden()
        assert ridden.ride(ticks=7) == Ending("end of run")
        assert (len(ridden.rows), ridden.rig.ticks) == (7, 7)

    def test_what_is_shown_is_the_bicycle_of_this_tick(self):
        ridden = Ridden()
        ridden.ride()
        assert [state.time for state in ridden.rig.shown] == ridden.column("time")
        assert [state.roll for state in ridden.rig.shown] == ridden.column("roll")


class TestRecord:
    def test_a_row_has_all_channels(self):
        ridden = Ridden()
        ridden.ride()
        channels = len(TICK_CHANNELS) + 1 + len(TIMING_CHANNELS)
        assert {len(row) for row in ridden.rows} == {channels}

    def test_a_row_is_what_the_parts_said(self):
        ridden = Ridden(course=Course(4.0, Moments(3.0, 0.5)))
        ridden.ride()
        for k, state in enumerate(ridden.rig.shown):
            row = {name: ridden.rows[k][i] for name, i in COLUMN.items()}
            for name in COLUMN.keys() & set(BicycleState._fields):
                assert row[name] == getattr(state, name), name
            assert (row["roll_moment"], row["steer_moment"]) == (3.0, 0.5)
            assert row["allowed_torque"] == state.feedback_torque

    def test_what_was_sent_is_what_the_rig_says(self):
        ridden = Ridden()
        ridden.ride()
        allowed, sent = (ridden.column(f"{name}_torque") for name in ("allowed", "sent"))
        assert sent == [0.5 * torque for torque in allowed]
        assert any(sent)

    def test_the_rigs_own_channels_follow(self):
        ridden = Ridden()
        ridden.ride()
        assert [row[len(TICK_CHANNELS)] for row in ridden.rows] == [0, 1, 2, 3]

    def test_times_on_the_wall_rise_from_zero(self):
        ridden = Ridden()
        ridden.ride()
        wall, compute = ([row[i] for row in ridden.rows] for i in (-2, -1))
        assert wall == sorted(wall)
        assert 0 <= wall[0] < 0.1
        assert all(0 < took < 0.1 for took in compute)

    def test_the_first_tick_starts_where_it_is_told(self):
        ridden = Ridden()
        ridden.ride(start=Start(roll=0.1, roll_rate=0.2, heading=0.3))
        first = {name: ridden.rows[0][i] for name, i in COLUMN.items()}
        assert (first["roll"], first["heading"]) == (0.1, 0.3)
        assert first["roll_rate"] == pytest.approx(0.2, abs=1e-15)
        assert (first["x"], first["distance"]) == (0, 0)

    def test_with_haptics_off_zero_is_sent(self):
        ridden = Ridden()
        ridden.ride(Law.OFF)
        assert ridden.column("sent_torque") == [0] * 4


class TestEnd:
    def assert_safe(self, ridden: Ridden) -> None:
        assert ridden.calls[-1] == "close"
        assert (ridden.rig.closed, ridden.rig.sent) == (1, 0.0)

    def test_of_a_whole_run_is_at_zero_torque(self):
        ridden = Ridden()
        ridden.ride()
        self.assert_safe(ridden)

    @pytest.mark.parametrize("error", [RuntimeError("broken"), KeyboardInterrupt(), SystemExit()])
    @pytest.mark.parametrize("fails", TICK)
    def test_by_an_error_of_any_part_is_at_zero_torque(self, fails: str, error: BaseException):
        ridden = Ridden(fails, error)
        with pytest.raises(type(error)):
            ridden.ride()
        self.assert_safe(ridden)

    def test_by_a_fall_is_a_result_with_its_time(self):
        ridden = Ridden()
        ending = ridden.ride(start=Start(roll=math.radians(44.99), roll_rate=0.1), ticks=1000)
        assert ending.fell
        assert ending.fall_time == ridden.rows[-1][0] > 0
        assert abs(ridden.column("roll")[-1]) > math.pi / 4
        assert ridden.column("sent_torque")[-1] == 0.0
        self.assert_safe(ridden)

    def test_by_the_bars_stop_is_a_fall(self):
        ridden = Ridden()
        ridden.rig.samples = lambda k: Sample(k * PERIOD, 0.3 * k, 0.0)
        ending = ridden.ride(ticks=10)
        assert ending.fell
        assert "stop" in ending.reason
        assert ending.fall_time == pytest.approx(0.004)

    @pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
    @pytest.mark.parametrize("field", ["steer", "steer_rate"])
    def test_by_a_sensor_that_says_nonsense_is_a_fault_and_recorded(self, field: str, value: float):
        ridden = Ridden()
        good = ridden.rig.samples
        ridden.rig.samples = lambda k: good(k)._replace(**({field: value} if k == 2 else {}))
        ending = ridden.ride()
        assert ending.reason.startswith("fault")
        assert not ending.fell
        assert ending.fall_time is None
        assert len(ridden.rows) == 3
        assert ridden.column("sent_torque")[-1] == 0.0
        self.assert_safe(ridden)

    def test_by_interruption_keeps_the_tick_in_progress(self):
        ridden = Ridden()
        asked = iter([False, False, True])
        assert ridden.ride(interrupted=lambda: next(asked)) == Ending("interrupted")
        assert len(ridden.rows) == 3
        self.assert_safe(ridden)

    def test_of_the_rigs_samples_ends_the_run(self):
        ridden = Ridden("read", RigFinished("end of the recording"))
        assert ridden.ride() == Ending("end of the recording")
        assert len(ridden.rows) == 2
        self.assert_safe(ridden)
