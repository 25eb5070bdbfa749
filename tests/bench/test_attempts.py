"""Row 23: a bicycle that fell stands upright again, for another attempt."""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path

import can
import pytest

from bikesim.bench import attempts
from bikesim.bench.asking import TURNED
from bikesim.bench.attempts import run_bench
from bikesim.bench.display import ScreenReader, screen_name
from bikesim.bench.ride import Order
from bikesim.bench.scenario import bench_scenario
from bikesim.record.header import Ending
from bikesim.record.reader import open_run

from .lockstep import leaning, profile
from .processes import Bench, written

FELL = Ending("fell to the right: roll beyond 40 deg", fell=True, fall_time=1.0)


@dataclass
class Rides:
    """Stands in for the rides themselves: how each ends, and what it was told to do."""

    endings: list[Ending]
    ridden: list[tuple[Order, Path]] = field(default_factory=list)
    standing: list[bool] = field(default_factory=list)

    def ride(self, order, ready, screen, output, **_) -> Ending:
        self.ridden.append((order, output))
        return self.endings[len(self.ridden) - 1]

    def wait(self, bench) -> None:
        reader = ScreenReader(screen_name(bench.bus))
        reader.look()
        self.standing.append(reader.standing)
        assert f"attempt {len(self.ridden) + 1} of" in reader.words
        reader.close()


def rides(monkeypatch: pytest.MonkeyPatch, *endings: Ending) -> Rides:
    made = Rides(list(endings))
    monkeypatch.setattr(attempts, "ride_once", made.ride)
    monkeypatch.setattr(attempts, "_until_asked", made.wait)
    return made


def order(**keys) -> Order:
    bench = profile()
    return Order("here", bench, bench_scenario(bench, leaning(speed=5.0)), uncommissioned=True,
                 without_margin=2, **keys)  # fmt: skip


def test_after_a_fall_the_next_and_no_more_than_wanted(monkeypatch: pytest.MonkeyPatch):
    made = rides(monkeypatch, FELL, FELL, FELL, FELL)
    wanted = order(pulse=True, frames=Path("a/r.blf"))
    records = run_bench(wanted, Path("a/r.h5"), attempts=3, say=lambda line: None)
    assert records == [Path("a/r.h5"), Path("a/r-2.h5"), Path("a/r-3.h5")]
    assert [output for _, output in made.ridden] == records
    assert [one.frames for one, _ in made.ridden] == [
        Path("a/r.blf"), Path("a/r-2.blf"), Path("a/r-3.blf"),
    ]  # fmt: skip
    # Hands are off a bar for a pulse, on it afterwards.
    assert [one.pulse for one, _ in made.ridden] == [True, False, False]
    assert made.standing == [True, True]


@pytest.mark.parametrize(
    "ending", [Ending("end of run"), Ending("interrupted"), Ending("fault 21: an emergency stop")]
)
def test_only_a_fall_is_tried_again(monkeypatch: pytest.MonkeyPatch, ending: Ending):
    made = rides(monkeypatch, FELL, ending, FELL)
    records = run_bench(order(), Path("r.h5"), attempts=5, say=lambda line: None)
    assert len(records) == len(made.ridden) == 2


def test_unasked_there_is_one(monkeypatch: pytest.MonkeyPatch):
    made = rides(monkeypatch, FELL, FELL)
    said: list[str] = []
    assert run_bench(order(), Path("r.h5"), say=said.append) == [Path("r.h5")]
    assert len(made.ridden) == 1
    assert any("stands upright again" in line for line in said)


def test_ctrl_c_between_two_keeps_what_was_ridden(monkeypatch: pytest.MonkeyPatch):
    made = rides(monkeypatch, FELL, FELL)

    def interrupted(bench) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(attempts, "_until_asked", interrupted)
    assert run_bench(order(), Path("r.h5"), attempts=2, say=lambda line: None) == [Path("r.h5")]
    assert len(made.ridden) == 1


@pytest.mark.slow
@pytest.mark.real_time
def test_fell_asked_and_rode_again(tmp_path: Path):
    """Host and emulated bench: between two rides there is no torque, whatever the bar does."""
    path = written("cia402-emulated", tmp_path)
    path.write_text(path.read_text().replace("fall_roll_deg = 40.0", "fall_roll_deg = 6.0"))
    bench = Bench(path)
    ended = bench.until_in_time(
        "run", str(path), "--uncommissioned", "--attempts", "2", "--duration", "20",
        "--set", "start.roll_deg=5.5", "--speed", "2", "-o", "r.h5", "--json",
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    summaries = json.loads(ended.stdout)["attempts"]
    assert [one["fell"] for one in summaries] == [True, True]
    runs = [open_run(tmp_path / name) for name in ("r.h5", "r-2.h5")]
    for run in runs:
        assert run.ending is not None
        assert run.ending.fell
        assert run.channel("sent_torque")[-1] == 0.0
        assert math.degrees(run.channel("roll")[0]) == pytest.approx(5.5)
        assert (can.BLFReader(str(run.path.with_suffix(".blf"))).object_count) > 100
    turned = [now for now, angle in bench.angles if abs(angle) > TURNED]
    asked = [now for now in turned if now - turned[0] > 0 and _at_rest(bench, now)]
    assert asked, "nobody asked"
    assert bench.torques[-1][1] == 0.0


def _at_rest(bench: Bench, now: float) -> bool:
    """Whether there was no torque for half a second before and after."""
    return all(torque == 0.0 for time, torque in bench.torques if abs(time - now) < 0.5)
