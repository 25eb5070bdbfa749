"""bikesim render, and bikesim run --video."""

import json
import os
import re
import signal
import time
from pathlib import Path

import av
import h5py
import pytest

from bikesim.view import gl
from bikesim.view.gl import Backend, find_backend

SMALL = ("--view", "bench", "--quality", "draft", "--size", "320x180", "--fps", "10")


@pytest.fixture(scope="module")
def backend() -> Backend:
    return find_backend()


@pytest.fixture(autouse=True)
def sought_once(monkeypatch, backend: Backend) -> None:
    """Looking for an OpenGL takes a second, which only those tests spend that are about it."""
    monkeypatch.setattr(
        gl, "find_backend", lambda: find_backend() if "MUJOCO_GL" in os.environ else backend
    )


def frames(path: Path) -> int:
    with av.open(str(path)) as container:
        return sum(1 for _ in container.decode(video=0))


def test_makes_a_video_beside_the_record(cli, record: Path):
    said = cli("render", record, *SMALL)
    assert (said.status, said.out.split(":")[0]) == (0, f"video   {record.with_suffix('.mp4')}")
    assert re.fullmatch(r"drawing with \w+ (in software|on the GPU) \(.*\)\n", said.err)
    assert frames(record.with_suffix(".mp4")) == 11


def test_json_tells_what_was_made(cli, record: Path):
    told = json.loads(cli("render", record, *SMALL, "--speed", 0.5, "--json").out)
    assert (told["frames"], told["interrupted"]) == (21, False)
    assert told["backend"] in ("egl", "osmesa", "glfw")
    assert told["seconds"] == pytest.approx(2.098, abs=1e-3)


def test_a_still_of_a_time(cli, record: Path):
    assert cli("render", record, "--at", 0.5, *SMALL[:6], "-o", "frame.png").status == 0
    assert Path("frame.png").read_bytes().startswith(b"\x89PNG")


def test_a_killed_record_is_rendered_as_far_as_it_goes(cli, record: Path):
    with h5py.File(record, "r+") as file:
        for group in ("channels", "timing"):
            for name in file[group]:  # pyright: ignore[reportGeneralTypeIssues]
                file[f"{group}/{name}"][500:] = float("nan")  # pyright: ignore[reportIndexIssue]
        file.attrs["complete"] = False
    assert cli("render", record, *SMALL).status == 0
    assert frames(record.with_suffix(".mp4")) == 6 + 15  # its end stands for 1.5 s


def test_ctrl_c_leaves_a_video_that_plays(process, record: Path):
    slow = ("--view", "bench", "--quality", "draft", "--speed", "0.002")
    rendering = process("render", record, *slow, "-o", "cut.mp4")
    deadline = time.monotonic() + 60
    while not list(record.parent.glob(".cut.mp4*.part")):
        assert rendering.poll() is None, rendering.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    rendering.send_signal(signal.SIGINT)
    out, _ = rendering.communicate(timeout=30)
    assert rendering.returncode == 0
    told = re.search(r"cut\.mp4: ([1-9]\d*) frames, interrupted at \1 of 14986", out)
    assert told, out
    assert frames(record.with_name("cut.mp4")) == int(told[1])
    assert {path.name for path in record.parent.iterdir()} == {"run.h5", "cut.mp4"}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--at", "7"), "--at 7: outside the run, from 0 to 0.999 s"),
        (("--at", "nan"), "--at nan: a time in seconds"),
        (("--at", "1", "-o", "a.mp4"), "a.mp4: a still has the suffix .png, .jpg"),
        (("-o", "a.avi"), "a.avi: a video has the suffix .mp4, .webm, .gif"),
        (("-o", "a.png"), "a.png: a video has the suffix .mp4, .webm, .gif; a still has --at"),
        (("--size", "big"), "--size big: must be WIDTHxHEIGHT"),
        (("--size", "641x360"), "--size 641x360: a .mp4 has an even width"),
        (("--size", "90000x90000"), "--size 90000x90000: too large for this OpenGL"),
        (("--fps", "0"), "--fps 0.0: from 1 to 240"),
        (("--speed", "-1"), "--speed -1: from 0.001"),
        (("--view", "third"), "unknown --view 'third'; known: first, second, bench, both"),
        (("--quality", "high"), "unknown --quality 'high'"),
        (("--roll-cue", "--no-roll-cue"), "--roll-cue or --no-roll-cue, not both"),
        (("--sheet", "--at", "1"), "render --sheet: takes one record"),
        (("--fps", "60", "-o", "a.gif"), "--fps 60: a GIF has at most 50"),
        (("-o", "run.h5/a.mp4"), "run.h5 is not a folder"),
    ],
)
def test_bad_input_is_one_line(cli, record: Path, options, message: str):
    said = cli("render", record, *options)
    lines = [line for line in said.err.splitlines() if not line.startswith("drawing with")]
    assert (said.status, said.out, len(lines)) == (2, "", 1)
    assert message in lines[0]
    assert list(record.parent.iterdir()) == [record]


def test_a_video_that_is_there_is_kept(cli, record: Path):
    Path("run.mp4").write_text("precious")
    assert "is already there; --force replaces it" in cli("render", record, *SMALL).err
    assert Path("run.mp4").read_text() == "precious"


def test_no_record_is_refused(refusal):
    assert "RUN.h5 is missing" in refusal("render")


def test_too_many_records_are_refused(cli, record: Path):
    assert "from one to 4 records, not 5" in cli("render", *[record] * 5).err


def test_a_record_without_a_needed_channel_is_refused(cli, record: Path):
    with h5py.File(record, "r+") as file:
        del file["channels/heading"]
    assert "channel heading is missing" in cli("render", record, *SMALL).err


def test_a_run_is_filmed_where_it_was_asked_for(cli):
    said = cli("run", "--duration", 0.2, "-o", "run.h5", "--video", "film.mp4")
    assert (said.status, said.out.splitlines()[-1]) == (0, "video   film.mp4")
    assert frames(Path("film.mp4")) == 7


def test_a_run_without_opengl_is_otherwise_complete(cli, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "off")
    said = cli("run", "--duration", 0.2, "-o", "run.h5", "--video")
    assert said.status == 0
    assert said.err == (
        "note: no video: MUJOCO_GL=off forbids OpenGL, without which nothing can be drawn\n"
    )
    assert [path.name for path in Path().iterdir()] == ["run.h5"]


def test_a_kind_of_video_that_is_not_is_refused_before_the_run(refusal):
    assert "film.avi: a video has the suffix" in refusal("run", "-o", "run.h5", "--video=film.avi")
    assert not Path("run.h5").exists()
