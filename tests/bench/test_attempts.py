"""Row 23: a bicycle that fell stands upright again, for another attempt."""

import json
import math
import signal
import subprocess
import threading
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import can
import pytest

from bikesim.bench import attempts
from bikesim.bench.asking import ASK, HELD, TURNED
from bikesim.bench.attempts import Warmth, run_bench
from bikesim.bench.plant import Plant
from bikesim.bench.ride import Order, Ridden
from bikesim.bench.scenario import bench_scenario
from bikesim.bench.stopping import Stopping
from bikesim.record.header import Ending
from bikesim.record.reader import open_run

from .lockstep import leaning, profile
from .processes import Bench, written

FELL = Ending("fell to the right: roll beyond 40 deg", fell=True, fall_time=1.0)


@dataclass
class Rides:
    """Stands in for the rides themselves: how each ends, and what it was told to do."""

    endings: list[Ending]
    stopped: bool = False
    ridden: list[tuple[Order, Path]] = field(default_factory=list)
    warm: list[float] = field(default_factory=list)
    words: list[str] = field(default_factory=list)

    def ride(self, order, ready, screen, output, *, mean_square, **_) -> Ridden:
        self.ridden.append((order, output))
        self.warm.append(mean_square)
        return Ridden(self.endings[len(self.ridden) - 1], self.stopped, 4.0)

    def wait(self, bench, screen, words, say) -> None:
        self.words.append(words)


def rides(monkeypatch: pytest.MonkeyPatch, *endings: Ending) -> Rides:
    made = Rides(list(endings))
    monkeypatch.setattr(attempts, "ride_once", made.ride)
    monkeypatch.setattr(attempts, "_until_asked", made.wait)
    return made


def order(**keys) -> Order:
    bench = profile()
    return Order("here", bench, bench_scenario(bench, leaning(speed=5.0)), uncommissioned=True,
                 without_margin=2, **keys)  # fmt: skip


def quiet(line: str) -> None:
    del line


def test_after_a_fall_the_next_and_no_more_than_wanted(monkeypatch: pytest.MonkeyPatch):
    made = rides(monkeypatch, FELL, FELL, FELL, FELL)
    wanted = order(pulse=True, frames=Path("a/r.blf"))
    records = list(run_bench(wanted, Path("a/r.h5"), attempts=3, say=quiet))
    assert records == [Path("a/r.h5"), Path("a/r-2.h5"), Path("a/r-3.h5")]
    assert [output for _, output in made.ridden] == records
    assert [one.frames for one, _ in made.ridden] == [
        Path("a/r.blf"), Path("a/r-2.blf"), Path("a/r-3.blf"),
    ]  # fmt: skip
    # Hands are off a bar for a pulse, on it afterwards.
    assert [one.pulse for one, _ in made.ridden] == [True, False, False]
    # How it ended can still be read.
    assert made.words == [f"{FELL.reason}; {ASK}, for attempt {n} of 3" for n in (2, 3)]
    # The motor is as warm as it was (row 13).
    assert made.warm == [0.0, pytest.approx(4.0, rel=0.05), pytest.approx(4.0, rel=0.05)]


def test_a_motor_cools_between_two():
    now = 0.0
    warm = Warmth(10.0, lambda: now)
    warm.keep(4.0)
    now = 10.0
    assert warm.left() == pytest.approx(4.0 / math.e)


@pytest.mark.parametrize(
    "ending", [Ending("end of run"), Ending("interrupted"), Ending("fault 21: an emergency stop")]
)
def test_only_a_fall_is_tried_again(monkeypatch: pytest.MonkeyPatch, ending: Ending):
    made = rides(monkeypatch, FELL, ending, FELL)
    records = list(run_bench(order(), Path("r.h5"), attempts=5, say=quiet))
    assert len(records) == len(made.ridden) == 2


def test_who_wanted_it_to_stop_is_not_made_to_ride_again(monkeypatch: pytest.MonkeyPatch):
    """Though the bicycle fell while the torque ramped out."""
    made = rides(monkeypatch, FELL, FELL)
    made.stopped = True
    assert list(run_bench(order(), Path("r.h5"), attempts=2, say=quiet)) == [Path("r.h5")]


def test_that_somebody_wanted_it_to_stop_is_remembered():
    told: list[str] = []
    stopping = Stopping(told.append)
    assert not stopping.asked
    stopping.on_signal(signal.SIGTERM, None)
    assert stopping.asked
    assert told == ["interrupted"]


def test_unasked_there_is_one(monkeypatch: pytest.MonkeyPatch):
    made = rides(monkeypatch, FELL, FELL)
    assert list(run_bench(order(), Path("r.h5"), say=quiet)) == [Path("r.h5")]
    assert (len(made.ridden), made.words) == (1, [])


def test_ctrl_c_between_two_keeps_what_was_ridden(monkeypatch: pytest.MonkeyPatch):
    made = rides(monkeypatch, FELL, FELL)

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(attempts, "_until_asked", interrupted)
    said: list[str] = []
    records = list(run_bench(order(), Path("r.h5"), attempts=2, say=said.append))
    assert records == [Path("r.h5")]
    assert len(made.ridden) == 1
    assert said[-1] == "stopped  interrupted: no more attempts"


def falling(folder: Path) -> Bench:
    path = written("cia402-emulated", folder)
    path.write_text(path.read_text().replace("fall_roll_deg = 40.0", "fall_roll_deg = 6.0"))
    return Bench(path)


RUN = (
    "--uncommissioned", "--attempts", "2", "--duration", "20", "--set", "start.roll_deg=5.5",
    "--speed", "2", "-o", "r.h5",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.real_time
def test_fell_asked_and_rode_again(tmp_path: Path):
    """Host and emulated bench: no torque, and no ride, before the bar was turned and held."""
    bench = falling(tmp_path)
    ended = bench.until_in_time("run", str(bench.path), *RUN, "--json")
    assert ended.returncode == 0, ended.stderr
    summaries = json.loads(ended.stdout)["attempts"]
    assert [one["fell"] for one in summaries] == [True, True]
    for name in ("r.h5", "r-2.h5"):
        run = open_run(tmp_path / name)
        assert run.ending is not None
        assert run.ending.fell
        assert run.channel("sent_torque")[-1] == 0.0
        assert math.degrees(run.channel("roll")[0]) == pytest.approx(5.5)
        assert can.BLFReader(str((tmp_path / name).with_suffix(".blf"))).object_count > 100
    acting = [now for now, torque in bench.torques if torque != 0.0]
    again = next(b for a, b in pairwise(acting) if b - a > 1.0)
    fell = max(now for now in acting if now < again)
    between = [(now, angle) for now, angle in bench.angles if fell + 0.5 < now < again]
    turned = [now for now, angle in between if abs(angle) > TURNED]
    assert turned, "nobody asked"
    assert again - turned[-1] > HELD
    assert bench.torques[-1][1] == 0.0


@pytest.mark.slow
@pytest.mark.real_time
def test_who_does_not_ask_is_left_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """And Ctrl-C ends it, with what was ridden."""
    monkeypatch.setattr(Plant, "ask", lambda plant, *, asked: None)
    bench = falling(tmp_path)
    timers: list[threading.Timer] = []

    def stop_later(host: subprocess.Popen[str], since: float) -> None:
        if not timers:
            timers.append(threading.Timer(8.0 - since, host.send_signal, (signal.SIGINT,)))
            timers[0].start()

    ended = bench.with_host("run", str(bench.path), *RUN, "--force", do=stop_later)
    timers[0].join()
    assert ended.returncode == 0, ended.stderr
    assert "waiting  fell to the right: roll beyond 6 deg; " in ended.stdout
    assert ended.stdout.count("arming") == 1
    assert "no more attempts" in ended.stdout
    assert [path.name for path in tmp_path.glob("*.h5")] == ["r.h5"]
    acting = [now for now, torque in bench.torques if torque != 0.0]
    assert max(acting) - min(acting) < 2.0
    assert bench.torques[-1][0] - max(acting) > 4.0
