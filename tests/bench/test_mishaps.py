"""When mishaps happen and when they are over; what becomes of them in a ride: test_faults_*."""

import re
from pathlib import Path
from typing import get_args

import pytest

from bikesim.bench.cia402 import State
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.odrive import EmulatedODrive
from bikesim.bench.frame import Frame
from bikesim.bench.mishaps import Mishap, Mishaps, read_mishaps
from bikesim.bench.odrive import AxisState
from bikesim.bench.plant import Plant
from bikesim.errors import InputError

from .lockstep import DRIVES, LockStep, leaning, profile

KINDS = get_args(Mishap.model_fields["kind"].annotation)


def test_the_documentation_lists_each_kind(repository: Path):
    section = (repository / "docs" / "bench.md").read_text().partition("### Faults to try")[2]
    cells = re.findall(r"^\| ((?:`\w+`(?:, )?)+) \|", section, re.MULTILINE)
    assert sorted(re.findall(r"\w+", " ".join(cells))) == sorted(KINDS)


@pytest.mark.parametrize(
    ("riding", "since"),
    [(None, None), (1.9, None), (2.0, 0.0), (2.4, 0.4), (2.5, None)],
)
def test_from_a_time_of_the_ride_on(riding: float | None, since: float | None):
    mishap = Mishap(kind="slip", time=2.0, duration=0.5)
    assert mishap.since(riding) == (None if since is None else pytest.approx(since))


def test_always():
    assert Mishap(kind="slip").since(None) == Mishap(kind="slip").since(3.0) == 0.0


def test_a_duration_of_what_never_begins(tmp_path: Path):
    file = tmp_path / "m.toml"
    file.write_text('[[mishaps]]\nkind = "slip"\nduration = 1.0\n')
    with pytest.raises(InputError, match=r"duration = 1 s: needs a time"):
        read_mishaps(file)


@pytest.fixture(params=DRIVES)
def bench(request: pytest.FixtureRequest) -> LockStep:
    return LockStep(profile(DRIVES[request.param]), leaning())


def test_a_bench_is_well_again_when_the_ride_is_over(bench: LockStep):
    """All but the drive's own error and state, which its host has to reset."""
    before = state(bench.plant, Mishaps(bench.plant, ()))
    for kind in KINDS:
        mishaps = Mishaps(bench.plant, [Mishap(kind=kind, time=1.0, value=0.3)])
        for riding in (None, 0.999):
            mishaps.happen(riding)
            assert state(bench.plant, mishaps) == before, kind
        mishaps.happen(1.0)
        if kind not in ("fail", "disable"):
            assert state(bench.plant, mishaps) != before, kind
        mishaps.happen(None)
        assert state(bench.plant, mishaps) == before, kind


@pytest.mark.parametrize("frame_id", [0x110, 0x111, 0x113, 0x120])
def test_a_silent_drive_leaves_the_sensors_their_voice(bench: LockStep, frame_id: int):
    """Answers about the calibration too."""
    mishaps = Mishaps(bench.plant, [Mishap(kind="silence")])
    mishaps.happen(None)
    frame = Frame(frame_id, bytes(8))
    assert list(mishaps.pass_to_host(frame)) == [frame]
    assert list(mishaps.pass_to_host(Frame(0x185, bytes(8)))) == []


def state(plant: Plant, mishaps: Mishaps) -> tuple[object, ...]:
    """Of everything that a mishap changes."""
    node, drive = plant.node, plant.drive
    assert isinstance(drive, EmulatedDrive | EmulatedODrive)
    mode = drive._stuck_mode if isinstance(drive, EmulatedDrive) else drive._modes
    sent = [Frame(0x110, bytes(8)), Frame(0x110, bytes((1, *bytes(7)))), Frame(0x185, bytes(8))]
    return (
        node.pot, node.gyro, node.estop_closed, drive.strength, drive.offset, mode,
        plant.bar.data.qfrc_applied[0], mishaps.hears_host,
        all(list(mishaps.pass_to_host(frame)) == [frame] for frame in sent),
    )  # fmt: skip


def test_a_drive_that_is_disabled_by_itself(bench: LockStep):
    bench.arm()
    assert bench.parts.rig.drive_view.enabled
    Mishaps(bench.plant, [Mishap(kind="disable")]).happen(None)
    drive = bench.plant.drive
    assert isinstance(drive, EmulatedDrive | EmulatedODrive)
    assert drive.state in (State.SWITCH_ON_DISABLED, AxisState.IDLE)
    bench.parts.rig.close()
