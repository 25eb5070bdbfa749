"""Small parts of a ride on a bench."""

import math
import signal
import tomllib
from itertools import pairwise
from pathlib import Path

import pytest
import tomli_w

from bikesim.bench.check import remember
from bikesim.bench.faults import Observation, Reaction
from bikesim.bench.profile import bench_names, load_bench
from bikesim.bench.scenario import bench_scenario, header_text, profile_of
from bikesim.bench.stopping import Stopping
from bikesim.bench.wheel_course import Wheel, WheelCourse, WheelSilent
from bikesim.bench.wheel_node import WheelEncoder, WheelSettings
from bikesim.data import data_path
from bikesim.experiment.scenario import Scenario, to_toml
from bikesim.loop import Moments

from .lockstep import LockStep, leaning, profile


class TestProfilesThatShip:
    @pytest.mark.parametrize("name", bench_names())
    def test_is_valid(self, name: str):
        assert load_bench(name).description

    @pytest.mark.parametrize("name", ["cia402-emulated", "odrive-emulated"])
    def test_an_emulated_one_needs_no_pulse(self, name: str):
        assert load_bench(name).commissioned == load_bench(name).commissioning

    def test_one_to_be_copied_has_never_passed_it(self):
        assert load_bench("example-socketcan").commissioned == ""


class TestRemembering:
    @pytest.fixture
    def file(self, tmp_path: Path) -> Path:
        bench = profile().model_dump(mode="json", exclude_none=True)
        file = tmp_path / "mine.toml"
        file.write_text("# a bench\n" + tomli_w.dumps({**bench, "commissioned": "old"}))
        return file

    def test_in_a_file_of_ones_own_and_what_was_is_kept(self, file: Path):
        before = file.read_text()
        bench = load_bench(str(file))
        said = remember(str(file), bench)
        assert load_bench(str(file)).commissioned == bench.commissioning
        assert file.read_text() == before.replace('"old"', f'"{bench.commissioning}"')
        (kept,) = file.parent.glob("*.bak")
        assert kept.read_text() == before
        assert str(kept) in said
        assert remember(str(file), load_bench(str(file))).startswith("passed; as the profile says")
        assert len(list(file.parent.iterdir())) == 2

    def test_one_that_ships_is_not_written_to(self):
        path = data_path("hardware", "benches", "example-socketcan.toml")
        before, there = path.read_bytes(), sorted(path.parent.iterdir())
        bench = load_bench("example-socketcan")
        said = remember("example-socketcan", bench)
        assert f'write into a profile of your own: commissioned = "{bench.commissioning}"' in said
        assert (path.read_bytes(), sorted(path.parent.iterdir())) == (before, there)


def test_the_header_has_scenario_and_profile():
    bench = profile()
    scenario = bench_scenario(bench, Scenario(speed=4.0))
    text = header_text(bench, scenario)
    assert tomllib.loads(text) == tomllib.loads(to_toml(scenario))
    assert tomllib.loads(text)["rig"]["inertia"] == 0.2311
    assert tomllib.loads(profile_of(text)) == bench.model_dump(mode="json", exclude_none=True)


class Still:
    def speed(self, time: float) -> float:
        raise AssertionError

    def disturbance(self, time: float) -> Moments:
        return Moments(time, 0.0)


class TestWheel:
    settings = WheelSettings(radius=0.3)

    def wheel(self, *speeds: float, sensor_ok: bool = True) -> Wheel:
        wheel, encoder = Wheel(self.settings), WheelEncoder(self.settings)
        for k, speed in enumerate(speeds):
            wheel.receive(encoder.encode(0.01 * k, speed, 0, sensor_ok), 0.01 * k)
        return wheel

    def test_begins_with_its_speed_and_follows_no_faster_than_a_rider(self):
        wheel = self.wheel(4.0)
        course = WheelCourse(wheel, Still(), 10.0)
        assert course.speed(0.0) == pytest.approx(4.0, abs=0.003)
        wheel.speed = 5.0
        assert course.speed(0.1) == pytest.approx(4.4, abs=0.003)
        assert course.speed(0.2) == pytest.approx(4.8, abs=0.003)
        assert course.speed(0.3) == 5.0
        assert course.disturbance(7.0) == Moments(7.0, 0.0)

    @pytest.mark.parametrize(("says", "becomes"), [(-3.0, 0.0), (30.0, 10.0)])
    def test_neither_backwards_nor_faster_than_allowed(self, says: float, becomes: float):
        assert WheelCourse(self.wheel(says), Still(), 10.0).speed(0.0) == becomes

    def test_a_sensor_that_is_not_well_is_not_believed(self):
        assert self.wheel(4.0, sensor_ok=False).arrival == -math.inf

    def test_silent_for_half_a_second_ramps_out(self):
        wheel = self.wheel(4.0)
        look = WheelSilent(wheel, 0.5)
        assert look(at(0.0)) is None
        assert look(at(0.4)) is None
        wheel.arrival = 0.5
        assert look(at(0.6)) is None
        assert look(at(1.09)) is None
        fault = look(at(1.11))
        assert fault is not None
        assert fault.reaction is Reaction.RAMP
        assert str(fault) == "fault 26: no good speed frame for 0.51 s; allowed 0.5 s"


def at(time: float) -> Observation:
    return Observation(
        time, 0.0, 0.0, True, time, 0.0, 0, 0, True, True, True, True, 0.0, 0.0, "", "", 0.0, 0.0,
        0.0, "", False,
    )  # fmt: skip


class TestWheelRide:
    """The speed of the equations is the wheel's."""

    def ridden(self, wrong, **thresholds: float) -> LockStep:
        keys = {"wheel": {"radius": 0.3}, "thresholds": thresholds}
        bench = LockStep(profile(**keys), Scenario(speed=4.0, duration=2.0))
        show = bench.plant.show

        def shown(bicycle) -> None:
            show(bicycle)
            wrong(bench, bicycle.time)

        def hooked() -> None:
            bench.parts.rig.hooks = bench.parts.rig.hooks._replace(show=shown)

        bench.ending = bench.ride(before=hooked)
        return bench

    def test_it_follows(self):
        def faster(bench: LockStep, time: float) -> None:
            assert bench.plant.wheel is not None
            bench.plant.wheel.speed = 4.0 if time < 0.5 else 5.0

        bench = self.ridden(faster)
        assert bench.ending.reason == "end of run"
        speed = bench.rows.channel("speed")
        assert speed[400] == pytest.approx(4.0, abs=0.003)
        assert speed[1000] == pytest.approx(5.0, abs=0.003)
        assert max(b - a for a, b in pairwise(speed)) < 0.0041

    @pytest.mark.parametrize("silent", [0.2, 0.5])
    def test_it_is_lost(self, silent: float):
        def lost(bench: LockStep, time: float) -> None:
            assert bench.plant.wheel is not None
            bench.plant.wheel.sensor_ok = time < 0.5

        bench = self.ridden(lost, wheel_silent=silent)
        assert bench.ending.reason.startswith("fault 26: no good speed frame")
        assert bench.rows[-1][0] == pytest.approx(0.5 + silent + 0.1, abs=0.02)
        assert bench.plant.torque == 0.0


class TestSignals:
    def test_the_first_asks_the_second_insists(self, monkeypatch: pytest.MonkeyPatch):
        now = [0.0]
        monkeypatch.setattr("bikesim.bench.stopping.time.monotonic", lambda: now[0])
        asked: list[str] = []
        stopping = Stopping(asked.append)
        stopping.on_signal(signal.SIGINT, None)
        now[0] = 0.1  # timeout(1) sends it twice
        stopping.on_signal(signal.SIGINT, None)
        assert (asked, stopping()) == (["interrupted"], False)
        now[0] = 1.0
        stopping.on_signal(signal.SIGINT, None)
        assert (asked, stopping()) == (["interrupted"], True)

    def test_handlers_are_given_back(self):
        before = signal.getsignal(signal.SIGTERM)
        with Stopping(lambda why: None).watching():
            assert signal.getsignal(signal.SIGTERM) != before
        assert signal.getsignal(signal.SIGTERM) == before

    def test_asked_to_stop_it_ramps_out(self):
        bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning())
        ride = bench.prepared()
        bench.arm()
        bench.parts.rig.hooks = bench.parts.rig.hooks._replace(
            show=lambda bicycle: ride.guard.ask_to_stop("interrupted") if bicycle.time > 0.5 else 0
        )
        assert ride.go().reason == "interrupted"
        assert bench.rows[-1][0] == pytest.approx(0.6, abs=0.003)
        torque = bench.rows.channel("sent_torque")
        assert torque[-1] == 0.0
        assert 0.4 < torque[-50] / torque[-100] < 0.6

    def test_insisted_on_it_is_zero_at_once(self):
        bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning())
        ending = bench.ride(interrupted=lambda: len(bench.rows) > 500)
        assert ending.reason == "interrupted"
        assert len(bench.rows) == 501
        assert bench.plant.torque == 0.0
        assert bench.parts.rig.disabled is True


def test_an_exception_in_the_loop_disables_the_drive():
    bench = LockStep(profile(thresholds={"ramp_in": 0.05}), leaning())
    ride = bench.prepared()
    bench.arm()

    def broken(bicycle) -> None:
        if bicycle.time > 0.5:
            raise ZeroDivisionError

    bench.parts.rig.hooks = bench.parts.rig.hooks._replace(show=broken)
    with pytest.raises(ZeroDivisionError):
        ride.go()
    assert bench.plant.torque == 0.0
    assert bench.parts.rig.disabled is True
    assert bench.sim.closed
