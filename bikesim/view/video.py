"""From records to a video."""

import contextlib
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from pathlib import Path

import numpy as np

from bikesim.errors import InputError
from bikesim.record.output import output_path, put_in_place, unwritable
from bikesim.record.reader import Run
from bikesim.view.crew import Crew, Pixels, workers_for
from bikesim.view.encode import Encoder, VideoEncoder, suffix_of
from bikesim.view.film import Film
from bikesim.view.gif import GifEncoder
from bikesim.view.gl import Backend
from bikesim.view.layout import make_layout
from bikesim.view.pose import PoseTrack
from bikesim.view.quality import Quality, drawn_size
from bikesim.view.reel import make_reel, timeline
from bikesim.view.timeline import CLOCK, Timeline

_PALETTE_FRAMES = 12
_FASTEST_GIF = 50  # frames a second; browsers slow down faster ones


@dataclass(frozen=True)
class Look:
    """How a run is shown. `view` None: both views of one run, the second of several.

    `overlay`: what is written over and under the pictures; `roll_cue`: whether the lean is to be
    seen, None: if the rider of the run saw it.
    """

    view: str | None = None
    width: int = 1280
    height: int = 720
    quality: Quality = Quality.GOOD
    overlay: bool = True
    roll_cue: bool | None = None


@dataclass(frozen=True)
class Made:
    """A video: `frames` of `planned`, fewer if interrupted; `seconds` it plays.

    `render_time` is the wall time a frame [s], start of the processes included; `workers` drew.
    """

    output: Path
    frames: int
    planned: int
    seconds: float
    render_time: float
    workers: int


Watch = Callable[[int], AbstractContextManager[Callable[[], bool]]]


def _unwatched(_: int) -> AbstractContextManager[Callable[[], bool]]:
    return contextlib.nullcontext(lambda: False)


def make_video(
    runs: Sequence[Run],
    output: Path,
    look: Look,
    backend: Backend,
    *,
    fps: Fraction = Fraction(30),
    speed: float = 1.0,
    force: bool = False,
    watch: Watch = _unwatched,
) -> Made:
    """Draw the runs side by side into a video, and put it in place when it is whole.

    `watch(frames)` gives what is asked after each frame whether to stop; what was made by then is
    kept. Raises InputError.
    """
    suffix = suffix_of(output)
    _check_size(look, suffix)
    if suffix == ".gif" and fps > _FASTEST_GIF:
        raise InputError(f"--fps {float(fps):g}: a GIF has at most {_FASTEST_GIF}")
    target = output_path(output, force=force)
    film, times = make_film(runs, look, backend, fps=fps, speed=speed)
    ticks = times.ticks().tolist()
    began = time.perf_counter()
    try:
        with put_in_place(target) as part, watch(len(ticks)) as interrupted:
            frames = _write(part, suffix, film, ticks, fps, backend, interrupted)
    except OSError as error:
        raise unwritable(output, error) from error
    took = time.perf_counter() - began
    seconds = ticks[frames - 1] / CLOCK + float(1 / fps)
    return Made(output, frames, len(ticks), seconds, took / frames, workers_for(len(ticks)))


def make_film(
    runs: Sequence[Run], look: Look, backend: Backend, *, fps: Fraction, speed: float
) -> tuple[Film, Timeline]:
    """What the frames of a video are made from. Raises InputError."""
    tracks = [PoseTrack(run) for run in runs]
    times = timeline(runs, tracks, fps, speed)
    return film_at(runs, tracks, times.elapsed(), look, backend), times


def film_at(
    runs: Sequence[Run],
    tracks: Sequence[PoseTrack],
    elapsed: np.ndarray,
    look: Look,
    backend: Backend,
) -> Film:
    """A film whose frames show the runs at these times since their begin [s]."""
    layout = make_layout(look.view, len(runs), look.width, look.height, strip=look.overlay)
    drawn = drawn_size(look.width, look.height, look.quality)
    if max(*drawn, look.width, look.height) > backend.largest:
        allowed = round(backend.largest / max(1.0, drawn[0] / look.width))
        raise InputError(
            f"--size {look.width}x{look.height}: too large for this OpenGL at quality "
            f"{look.quality}; at most {allowed}x{allowed}"
        )
    reels = (
        make_reel(run, track, elapsed, roll_cue=look.roll_cue)
        for run, track in zip(runs, tracks, strict=True)
    )
    return Film(tuple(reels), layout, elapsed, look.quality, look.overlay)


def _check_size(look: Look, suffix: str) -> None:
    if suffix != ".gif" and (look.width % 2 or look.height % 2):
        raise InputError(
            f"--size {look.width}x{look.height}: a {suffix} has an even width and height"
        )


def _write(
    path: Path,
    suffix: str,
    film: Film,
    ticks: Sequence[int],
    fps: Fraction,
    backend: Backend,
    interrupted: Callable[[], bool],
) -> int:
    """The frames of a film into a file; how many. Raises OSError, InputError."""
    width, height = film.layout.width, film.layout.height
    numbers = range(len(ticks))
    if suffix == ".gif":
        samples = _samples(len(ticks))
        with Crew(film, [*samples, *numbers], GifEncoder.pixels, backend) as crew:
            frames = crew.frames()
            encoder = GifEncoder(path, width, height, fps, islice(frames, len(samples)))
            return _encode(encoder, frames, ticks, interrupted)
    with Crew(film, numbers, VideoEncoder.pixels, backend) as crew:
        encoder = VideoEncoder(path, suffix[1:], width, height, fps, film.quality)
        return _encode(encoder, crew.frames(), ticks, interrupted)


def _samples(frames: int) -> list[int]:
    """Frames from begin to end, to choose a palette by."""
    return np.unique(np.linspace(0, frames - 1, _PALETTE_FRAMES).round().astype(int)).tolist()


def _encode(
    encoder: Encoder,
    frames: Iterable[Pixels],
    ticks: Sequence[int],
    interrupted: Callable[[], bool],
) -> int:
    written = 0
    with _closed(encoder):
        for frame, tick in zip(frames, ticks, strict=False):
            encoder.write(frame, tick)
            written += 1
            if interrupted():
                break
    return written


@contextlib.contextmanager
def _closed(encoder: Encoder) -> Iterator[None]:
    """Closes the file at the end; after an error whatever more closing it says is left unsaid."""
    try:
        yield
    except BaseException:
        with contextlib.suppress(OSError, ValueError):
            encoder.close()
        raise
    encoder.close()
