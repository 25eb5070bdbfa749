"""Frames written to a file, and what a player finds in it."""

from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest

from bikesim.errors import InputError
from bikesim.view.canvas import make_canvas
from bikesim.view.encode import VideoEncoder, suffix_of
from bikesim.view.gif import GifEncoder
from bikesim.view.layout import Box
from bikesim.view.quality import Quality
from bikesim.view.timeline import CLOCK

WIDTH, HEIGHT, FRAMES = 160, 96, 12
COLOURS = ((200, 30, 30), (30, 180, 40), (20, 60, 210))


def picture(k: int) -> np.ndarray:
    """Three stripes of colour, and a white mark that moves."""
    made = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    for stripe, colour in zip(np.array_split(made, 3), COLOURS, strict=True):
        stripe[:] = colour
    made[40:56, 8 * k : 8 * k + 16] = 255
    return made


def video(path: Path) -> Path:
    canvas = make_canvas(VideoEncoder.pixels, WIDTH, HEIGHT)
    kind = path.suffix[1:]
    encoder = VideoEncoder(path, kind, WIDTH, HEIGHT, Fraction(30), Quality.GOOD)
    for k in range(FRAMES):
        canvas.put(Box(0, 0, WIDTH, HEIGHT), picture(k))
        encoder.write(canvas.pixels, k * CLOCK // 30)
    encoder.close()
    return path


@pytest.fixture(scope="module")
def mp4(tmp_path_factory) -> Path:
    return video(tmp_path_factory.mktemp("mp4") / "video.mp4")


@pytest.fixture(scope="module")
def webm(tmp_path_factory) -> Path:
    return video(tmp_path_factory.mktemp("webm") / "video.webm")


@pytest.fixture(params=["mp4", "webm"])
def path(request: pytest.FixtureRequest) -> Path:
    return request.getfixturevalue(request.param)


def test_a_player_finds_what_browsers_play(mp4: Path):
    with av.open(str(mp4)) as container:
        stream = container.streams.video[0]
        assert (stream.codec_context.name, stream.codec_context.pix_fmt) == ("h264", "yuv420p")
        assert stream.average_rate == 30


def test_the_index_comes_before_the_pictures(mp4: Path):
    data = mp4.read_bytes()
    assert 0 < data.index(b"moov") < data.index(b"mdat")


def test_webm_is_vp9(webm: Path):
    with av.open(str(webm)) as container:
        assert container.streams.video[0].codec_context.name == "vp9"


def test_all_frames_are_there_at_their_times(path: Path):
    with av.open(str(path)) as container:
        times = [frame.time for frame in container.decode(video=0)]
    assert times == pytest.approx([k / 30 for k in range(FRAMES)], abs=6e-4)


def test_colours_come_back(path: Path, decoded):
    for frame, k in zip(decoded(path), range(FRAMES), strict=True):
        for row, colour in zip((16, 80), COLOURS[::2], strict=True):
            assert np.abs(frame[row, 80].astype(int) - colour).max() <= 8, k


def test_the_colours_are_marked_as_hd_colours(mp4: Path):
    with av.open(str(mp4)) as container:
        frame = next(iter(container.decode(video=0)))
    assert (frame.colorspace, frame.color_range) == (1, 1)  # BT.709, limited


def test_frames_come_in_order(path: Path, decoded):
    marks = [np.argwhere(frame[48].min(axis=1) > 200).mean() for frame in decoded(path)]
    assert (np.diff(marks) > 4).all()


def test_the_same_frames_are_the_same_file(mp4: Path, tmp_path: Path):
    assert video(tmp_path / "again.mp4").read_bytes() == mp4.read_bytes()


def test_a_gif_keeps_colours_and_times(tmp_path: Path, decoded):
    path = tmp_path / "video.gif"
    encoder = GifEncoder(path, WIDTH, HEIGHT, Fraction(10), [picture(0), picture(5)])
    for k in range(FRAMES):
        encoder.write(picture(k), k * CLOCK // 10)
    encoder.close()
    frames = decoded(path)
    assert len(frames) == FRAMES
    assert np.abs(frames[-1][16, 80].astype(int) - COLOURS[0]).max() <= 8
    assert b"NETSCAPE2.0\x03\x01\x00\x00" in path.read_bytes()  # loops for ever


@pytest.mark.parametrize("name", ["video.avi", "video.mp", "video"])
def test_another_suffix_is_refused(name: str):
    with pytest.raises(InputError, match=r"\.mp4, \.webm, \.gif"):
        suffix_of(Path(name))


def test_an_upper_case_suffix_is_taken():
    assert suffix_of(Path("VIDEO.MP4")) == ".mp4"
