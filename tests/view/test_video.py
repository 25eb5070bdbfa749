"""Records to videos, decoded again."""

import contextlib
import resource
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.record.reader import Run
from bikesim.view.crew import Crew
from bikesim.view.gl import Backend
from bikesim.view.quality import Quality
from bikesim.view.stills import make_sheet, make_still
from bikesim.view.video import Look, make_film, make_video

FPS = Fraction(10)


@pytest.fixture(scope="session")
def film(upright: Run, backend: Backend, tmp_path_factory) -> Path:
    """The bench over one second, ticks 0 to 0.999 s, at 10 Hz."""
    path = tmp_path_factory.mktemp("film") / "bench.mp4"
    look = Look(view="bench", width=320, height=180, quality=Quality.DRAFT)
    make_video([upright], path, look, backend, fps=FPS)
    return path


def still(run: Run, time: float, look: Look, backend: Backend, folder: Path) -> np.ndarray:
    import cv2

    path = make_still([run], time, folder / f"{time}.png", look, backend, force=True)
    picture = cv2.imread(str(path))
    assert picture is not None
    return picture[..., ::-1].astype(int)


def difference(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.abs(one.astype(int) - other).mean())


def test_has_a_frame_a_tenth_of_a_second_and_the_last_tick(film: Path, decoded):
    assert len(decoded(film)) == 11


def test_each_frame_is_the_record_of_its_time(film, upright, look, backend, tmp_path, decoded):
    whole, _ = make_film([upright], look, backend, fps=FPS, speed=1.0)
    with Crew(whole, [3, 10], "rgb24", backend) as crew:
        third, last = (frame.copy() for frame in crew.frames())
    np.testing.assert_array_equal(third, still(upright, 0.3, look, backend, tmp_path))
    np.testing.assert_array_equal(last, still(upright, 0.999, look, backend, tmp_path))
    assert (third != last).any()
    assert difference(decoded(film)[10], last) < 4


def test_made_again_it_is_the_same_file(film, upright, look, backend, tmp_path):
    again = tmp_path / "again.mp4"
    made = make_video([upright], again, look, backend, fps=FPS)
    assert again.read_bytes() == film.read_bytes()
    assert (made.frames, made.planned, made.seconds) == (11, 11, pytest.approx(1.099))


def test_without_overlay_only_the_overlay_is_missing(upright, look, backend, tmp_path):
    with_ = still(upright, 0.5, look, backend, tmp_path)
    clean = still(upright, 0.5, replace(look, overlay=False), backend, tmp_path)
    changed = (with_ != clean).any(axis=2)
    assert changed[:20, :40].any()
    assert not changed[30:130].any()


def test_two_runs_stand_side_by_side_over_their_strips(
    upright, fallen, look, backend, tmp_path, decoded
):
    path = tmp_path / "two.mp4"
    look = replace(look, width=640, height=360)
    made = make_video([upright, fallen], path, look, backend, fps=Fraction(5))
    last = decoded(path)[-1].astype(int)
    assert made.frames == 6
    assert last[:200, 320:].mean() < 0.75 * last[:200, :318].mean()  # dark where it fell
    assert (last[-3:].mean(axis=(0, 2)) < 60).all()  # the strips


def test_an_interruption_keeps_what_was_made(upright, look, backend, tmp_path, decoded):
    answers = iter([False, False, True])
    path = tmp_path / "cut.mp4"
    watch = contextlib.nullcontext(lambda: next(answers))
    made = make_video([upright], path, look, backend, fps=FPS, watch=lambda _: watch)
    assert (made.frames, made.planned) == (3, 11)
    assert len(decoded(path)) == 3


def test_a_full_disk_is_one_line_and_leaves_nothing(upright, look, backend, tmp_path):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, before[1]))
    try:
        with pytest.raises(InputError, match=r"full\.mp4: cannot be written: file too large"):
            make_video([upright], tmp_path / "full.mp4", look, backend, fps=FPS)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".webm", ".gif"])
def test_other_kinds_have_the_same_frames(suffix, upright, look, backend, tmp_path, decoded, film):
    path = tmp_path / f"video{suffix}"
    make_video([upright], path, look, backend, fps=FPS)
    frames = decoded(path)
    assert len(frames) == 11
    assert difference(frames[-1], decoded(film)[-1]) < 8


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"width": 321}, "--size 321x180: a .mp4 has an even width and height"),
        ({"width": 99998, "height": 180}, "--size 99998x180: too large for this OpenGL"),
        ({"width": 32}, "--size 32x180: at least 160x90"),
        ({"view": "side"}, "unknown --view 'side'"),
    ],
)
def test_what_cannot_be_drawn_is_refused(upright, look, backend, tmp_path, change, message):
    with pytest.raises(InputError, match=message):
        make_video([upright], tmp_path / "no.mp4", replace(look, **change), backend)
    assert list(tmp_path.iterdir()) == []


def test_a_size_that_opengl_refuses_is_one_line(upright, look, backend, tmp_path):
    lying = replace(backend, largest=10**6)
    with pytest.raises(InputError, match="OpenGL cannot draw a picture of 50000x50"):
        make_still(
            [upright], 0.5, tmp_path / "no.png", replace(look, width=100_000, height=100), lying,
            force=False,
        )  # fmt: skip


def test_a_sheet_shows_the_run_from_begin_to_end(upright, look, backend, tmp_path):
    import cv2

    path = make_sheet(
        upright, tmp_path / "sheet.png", replace(look, width=960, height=540), backend, force=False
    )
    sheet = cv2.imread(str(path))
    assert sheet is not None
    assert sheet.shape == (540, 960, 3)
    first, last = sheet[:135, :240], sheet[270:405, 720:]
    assert difference(first[:, :238], last[:, :238]) > 0.2
