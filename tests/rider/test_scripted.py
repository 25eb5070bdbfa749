"""Torques by the clock: their spectra, their times, their files."""

import hashlib
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.experiment.batch import ride_batch
from bikesim.experiment.run import build, ride_parts, run
from bikesim.experiment.scenario import Scenario
from bikesim.experiment.torque_record import with_recorded_torque
from bikesim.model.law import Law
from bikesim.path.path import straight_path
from bikesim.record.export import export_run
from bikesim.record.reader import open_run
from bikesim.rider.base import Setting, Sight
from bikesim.rider.script_settings import ScriptSettings
from bikesim.rider.scripted import Chirp, Multisine, Scripted
from bikesim.rider.settings import RiderSettings

STEP = 0.01
SIGHT = Sight(*[0.0] * 8)


def script(**given: Any) -> ScriptSettings:
    return ScriptSettings(**given)


@pytest.fixture(scope="module")
def setting() -> Setting:
    return Setting(bicycles.load("benchmark"), Law.PAPER, 0.23, 5.0, STEP, straight_path())


Played = Callable[..., np.ndarray]


@pytest.fixture
def played(setting: Setting) -> Played:
    def play(seconds: float, **given: Any) -> np.ndarray:
        rider = Scripted(setting, script=script(**given))
        return np.array([rider.intend(0.0, 0.0, SIGHT) for _ in range(round(seconds / STEP))])

    return play


def test_a_step_lasts_from_start_to_stop(played: Played):
    torque = played(3.0, kind="step", torque=-2.0, start=1.0, stop=2.5)
    assert set(torque[100:250]) == {-2.0}
    assert set(torque[:100]) | set(torque[250:]) == {0.0}


@pytest.mark.parametrize("phases", ["schroeder", "random"])
def test_a_multisine_has_its_lines_and_nothing_else(played: Played, phases: str):
    torque = played(20.0, kind="multisine", torque_rms=0.7, repeat=20.0, phases=phases)
    assert math.sqrt(np.mean(torque**2)) == pytest.approx(0.7, rel=1e-12)
    amplitude = np.abs(np.fft.rfft(torque)) * 2 / len(torque)
    lines = np.flatnonzero(amplitude > 1e-9)
    assert len(lines) == 12
    assert amplitude[lines] == pytest.approx(0.7 * math.sqrt(2 / 12))
    omega = 2 * math.pi / 20.0 * lines
    assert omega[0] == pytest.approx(0.6, abs=0.32)
    assert omega[-1] == pytest.approx(20.0, abs=0.32)
    assert omega == pytest.approx(Multisine(script(kind="multisine", repeat=20.0)).omega)


def test_schroeders_phases_keep_the_peaks_low(played: Played):
    """Linear spacing, which they are made for; random ones for comparison."""
    band = {"lowest": 1.0, "highest": 2 * math.pi * 0.1 * 40, "repeat": 10.0, "lines": 39}
    crest = {
        phases: np.abs(played(10.0, kind="multisine", phases=phases, **band)).max() / 0.5
        for phases in ("schroeder", "random")
    }
    assert crest["schroeder"] < 1.9 < crest["random"]


def test_random_phases_are_those_of_the_seed(played: Played):
    one, again, other = (
        played(5.0, kind="multisine", phases="random", seed=seed) for seed in (1, 1, 2)
    )
    assert one.tolist() == again.tolist()
    assert np.abs(one - other).max() > 0.1


@pytest.mark.parametrize("sweep", ["linear", "logarithmic"])
def test_a_chirp_sweeps_from_the_lowest_to_the_highest_frequency(sweep: str):
    chirp = Chirp(script(kind="chirp", lowest=1.0, highest=16.0, duration=40.0, sweep=sweep))
    time = np.linspace(0.0, 40.0, 400_001)
    torque = np.array([chirp(t) for t in time])
    zeros = time[np.flatnonzero(torque[:-1] * torque[1:] < 0)]
    middle, frequency = 0.5 * (zeros[1:] + zeros[:-1]), math.pi / np.diff(zeros)
    part = middle / 40.0
    expected = 1.0 + 15.0 * part if sweep == "linear" else 16.0**part
    assert frequency == pytest.approx(expected, rel=0.02)
    assert np.abs(torque).max() == pytest.approx(1.0, abs=1e-6)


def test_a_file_is_linear_between_its_times(played: Played, tmp_path: Path):
    file = tmp_path / "torque.csv"
    file.write_text("# by hand\n0.5, 1\n1.0, 3\n\n1.5, -1\n")
    torque = played(4.0, kind="file", file=str(file), start=1.0)
    time = STEP * np.arange(400) - 1.0
    expected = np.interp(time, [0.5, 1.0, 1.5], [1.0, 3.0, -1.0], left=0.0, right=0.0)
    assert torque == pytest.approx(expected, abs=1e-9)


def test_samples_may_be_given_in_place_of_a_file(played: Played):
    torque = played(1.0, kind="file", samples=[[0, 1], [1, 2]])
    assert torque == pytest.approx(1 + STEP * np.arange(100))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "0 samples: must be at least 2"),
        ("0, 1\n", "1 samples: must be at least 2"),
        ("0, 1\n0, 2\n", "times must rise from sample to sample, but 0.0 follows 0.0"),
        ("0, 1\n1, nan\n", "line 2: 'nan' must be a number"),
        ("0, 1\n1, two\n", "line 2: 'two' must be a number"),
        ("0, 1\n1\n", "line 2: 1 columns, time and torque are needed"),
        ("time, roll\n1, 2\n", "no column named torque; there are: time, roll"),
        ("\0", "is not a text file"),
    ],
)
def test_a_file_that_is_no_torque_is_refused(
    setting: Setting, tmp_path: Path, text: str, said: str
):
    file = tmp_path / "torque.csv"
    file.write_text(text)
    with pytest.raises(InputError) as refused:
        Scripted(setting, script=script(kind="file", file=str(file)))
    assert str(refused.value).startswith(f"rider.script.file {file}: ")
    assert said in str(refused.value)


def test_a_file_that_is_not_there_is_refused(setting: Setting, tmp_path: Path):
    with pytest.raises(InputError, match="no such file"):
        Scripted(setting, script=script(kind="file", file=str(tmp_path / "none.csv")))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"kind": "step", "lines": 3}, "kind step has no such figure; it has: torque, start, stop"),
        ({"kind": "step", "start": 2.0, "stop": 2.0}, "must come after start"),
        ({"kind": "file"}, "must be given"),
        ({"kind": "multisine", "highest": 0.5}, "must be at least lowest, 0.6"),
        ({"kind": "multisine", "lines": 100}, "there are 93 frequencies"),
        ({"kind": "chirp", "lowest": 2.0, "highest": 1.0}, "must be at least lowest, 2"),
        ({"kind": "sawtooth"}, "unknown rider.script.kind"),
    ],
)
def test_figures_that_do_not_go_together_are_refused(given: dict[str, Any], said: str):
    with pytest.raises(InputError, match=said):
        script(**given)


def test_lines_are_told_apart_where_they_are_dense():
    """As many lines as fit, each once."""
    cycles = Multisine(script(kind="multisine", lines=93)).omega * 30.0 / (2 * math.pi)
    assert cycles == pytest.approx(np.arange(3, 96))


def test_in_a_batch_all_have_what_each_has_alone(setting: Setting):
    batch, alone = (Scripted(setting, script=script(kind="multisine")) for _ in range(2))
    for _ in range(20):
        together = batch.intend(np.zeros(3), np.zeros(3), SIGHT)
        assert together.tolist() == [alone.intend(0.0, 0.0, SIGHT)] * 3


def person(**changed: Any) -> Scenario:
    """A tick for each physics step."""
    return Scenario(
        **{"period": 0.002, "physics_step": 0.002, "duration": 4.0, "seed": 3, **changed}
    )


def test_the_torque_of_a_record_gives_the_same_ride_again(tmp_path: Path):
    """Where each physics step has its tick, and the arms are the same."""
    run(build(person()), tmp_path / "person.h5")
    arms = {
        key: getattr(person().rider, key) for key in ("arm_inertia", "arm_damping", "arm_stiffness")
    }
    again = RiderSettings(
        name="torque-record", script=script(kind="record", file=str(tmp_path / "person.h5")), **arms
    )
    rows: list[tuple[float, ...]] = []

    class Rows:
        append = staticmethod(rows.append)

    ride_parts(build(person(rider=again)), Rows())
    recorded = open_run(tmp_path / "person.h5")
    steer = recorded.channel("steer")
    assert np.abs(steer).max() > math.radians(1)
    assert np.array(rows)[:, 1] == pytest.approx(steer, abs=1e-9)


def test_an_exported_run_is_a_torque_file(tmp_path: Path):
    run(build(person()), tmp_path / "person.h5")
    recorded = open_run(tmp_path / "person.h5")
    export_run(recorded, tmp_path / "person.csv")
    rider = RiderSettings(
        name="torque-file", script=script(kind="file", file=str(tmp_path / "person.csv"))
    )
    played = Scripted(
        Setting(bicycles.load("benchmark"), Law.PAPER, 0.2, 3.5, 0.002, straight_path()),
        script=rider.script or script(),
    )
    torque = [played.intend(0.0, 0.0, SIGHT) for _ in range(recorded.ticks)]
    assert torque == pytest.approx(recorded.channel("rider_torque"), abs=1e-9)


def test_a_record_that_is_not_there_is_refused(tmp_path: Path):
    rider = RiderSettings(
        name="torque-record", script=script(kind="record", file=str(tmp_path / "none.h5"))
    )
    with pytest.raises(InputError, match=r"rider\.script\.file .*none\.h5: no such file"):
        with_recorded_torque(rider)


def test_a_file_that_is_no_record_is_refused(tmp_path: Path):
    (tmp_path / "no.h5").write_text("no")
    rider = RiderSettings(
        name="torque-record", script=script(kind="record", file=str(tmp_path / "no.h5"))
    )
    with pytest.raises(InputError, match="is not an HDF5 file"):
        with_recorded_torque(rider)


class TestDigest:
    @pytest.fixture(params=["file", "record"])
    def scenario(self, request: pytest.FixtureRequest, tmp_path: Path) -> Scenario:
        """Half a second of the torque of a text file, or of a record."""
        file = tmp_path / "torque"
        if request.param == "file":
            file.write_text("0, 0.1\n1, -0.2\n")
        else:
            run(build(person(duration=0.5)), file)
        given = script(kind=request.param, file=str(file))
        rider = RiderSettings(name=f"torque-{request.param}", script=given)
        return person(duration=0.5, rider=rider)

    @pytest.fixture
    def again(self, scenario: Scenario, tmp_path: Path) -> Scenario:
        """What the record of a run says was ridden."""
        run(build(scenario), tmp_path / "run.h5")
        return Scenario(**tomllib.loads(open_run(tmp_path / "run.h5").scenario))

    def test_of_its_file_is_in_the_record(self, again: Scenario, tmp_path: Path):
        content = (tmp_path / "torque").read_bytes()
        assert again.rider.script is not None
        assert again.rider.script.digest == hashlib.sha256(content).hexdigest()

    def test_lets_the_same_file_ride_again(self, again: Scenario, tmp_path: Path):
        run(build(again), tmp_path / "again.h5")
        assert open_run(tmp_path / "again.h5").digest() == open_run(tmp_path / "run.h5").digest()

    def test_another_file_is_noticed_alone_and_in_a_batch(self, again: Scenario, tmp_path: Path):
        file = tmp_path / "torque"
        file.write_bytes(file.read_bytes() + b"\n")
        for ride in (build, lambda one: ride_batch([one, one])):
            with pytest.raises(InputError) as refused:
                ride(again)
            told = str(refused.value)
            assert told.startswith(f"rider.script.file {file}: is another file than it was: ")
            assert "\n" not in told

    def test_is_not_asked_for(self, scenario: Scenario, tmp_path: Path):
        build(scenario).rig.close()
        file = tmp_path / "torque"
        file.write_bytes(file.read_bytes() + b"\n")
        build(scenario).rig.close()
