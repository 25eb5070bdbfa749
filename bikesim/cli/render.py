"""bikesim render"""

import math
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from bikesim.cli.output import print_json
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError, unknown

if TYPE_CHECKING:
    from bikesim.experiment.watch import Watch
    from bikesim.record.reader import Run
    from bikesim.view.gl import Backend
    from bikesim.view.video import Look, Made


def _arg(metavar: str, text: str, *aliases: str) -> Any:
    return tyro.conf.arg(metavar=metavar, help=text, help_behavior_hint="", aliases=list(aliases))


@dataclass(frozen=True)
class Render:
    """Make a video of a record; of several, side by side. Or stills.

    From the rider's eyes, from behind, of the bench, or both of the first beside each other over
    the signals. Needs OpenGL (EGL or OSMesa), but no display and no GPU.
    """

    records: Annotated[
        tuple[Path, ...],
        tyro.conf.Positional,
        _arg("RUN.h5 [RUN.h5 ...]", "Run files, up to four."),
    ]
    view: Annotated[
        str | None,
        _arg(
            "{first,second,bench,both}",
            "From the rider's eyes, from behind, or the rig (default: both, first and second; "
            "second for several records).",
        ),
    ] = None
    output: Annotated[
        Path | None,
        _arg(
            "FILE",
            "The video, .mp4 (H.264), .webm or .gif; a still .png or .jpg (default: the first "
            "record's name with .mp4).",
            "-o",
        ),
    ] = None
    size: Annotated[
        str | None, _arg("WxH", "In pixels (default: 1280x720; 640x360 for a GIF).")
    ] = None
    fps: Annotated[float | None, _arg("HZ", "Frames a second (default: 30; 12.5 for a GIF).")] = (
        None
    )
    speed: Annotated[float, _arg("FACTOR", "Of time: 0.25 is four times slower (default: 1).")] = (
        1.0
    )
    quality: Annotated[
        str | None,
        _arg(
            "{draft,good,best}",
            "draft: half the pixels each way, no shadows; best: anti-aliased twice over (default: "
            "good; best for stills).",
        ),
    ] = None
    no_roll_cue: Flag = False
    """Keep the horizon level and the bicycle upright: no lean is to be seen. So it is anyway where
    the scenario has vision.roll_cue = false."""
    roll_cue: Flag = False
    """Show the lean even where the rider did not see it."""
    no_overlay: Flag = False
    """Only the pictures: nothing written over them, and no signals under them."""
    at: Annotated[
        float | None, _arg("SECONDS", "Only the frame of this time of the record, as a still.")
    ] = None
    sheet: Flag = False
    """Only a contact sheet of the run, as a still."""
    force: Flag = False
    """Replace a file that is there already."""
    json: Flag = False
    """Print JSON."""

    def __call__(self) -> int:
        from bikesim.record.reader import open_run
        from bikesim.view.gl import find_backend

        if not self.records:
            raise InputError("RUN.h5 is missing (bikesim render --help)")
        if self.sheet and (self.at is not None or len(self.records) > 1):
            raise InputError("render --sheet: takes one record, and no --at")
        if self.roll_cue and self.no_roll_cue:
            raise InputError("render: --roll-cue or --no-roll-cue, not both")
        if self.at is not None and not math.isfinite(self.at):
            raise InputError(f"--at {self.at}: a time in seconds")
        look, output = self._look(), self._output()
        check_kind(output, still=self._still)
        runs = [open_run(record) for record in self.records]
        backend = find_backend()
        if self._still:
            return self._make_still(runs, look, output, backend)
        made = render(
            runs, output, look, backend, fps=self._fps(), speed=self.speed, force=self.force
        )
        if self.json:
            print_json(video_json(made, look, backend))
        else:
            print(video_told(made))
        return 0

    @property
    def _still(self) -> bool:
        return self.sheet or self.at is not None

    def _output(self) -> Path:
        if self.output is not None:
            return self.output
        first = self.records[0]
        if self.sheet:
            return first.with_name(f"{first.stem}-sheet.png")
        return first.with_suffix(".png" if self._still else ".mp4")

    def _fps(self) -> float:
        if self.fps is not None:
            return self.fps
        return 12.5 if _is_gif(self._output()) else 30.0

    def _look(self) -> "Look":
        from bikesim.view.quality import Quality
        from bikesim.view.video import Look

        default = (1920, 1080) if self.sheet else (640, 360) if _is_gif(self._output()) else None
        width, height = parse_size(self.size) if self.size is not None else default or (1280, 720)
        quality = self.quality or ("best" if self._still else "good")
        if quality not in set(Quality):
            raise unknown("--quality", quality, Quality)
        return Look(
            self.view,
            width,
            height,
            Quality(quality),
            overlay=not self.no_overlay,
            roll_cue=None if self.roll_cue == self.no_roll_cue else self.roll_cue,
        )

    def _make_still(self, runs: "list[Run]", look: "Look", output: Path, backend: "Backend") -> int:
        from bikesim.view.stills import make_sheet, make_still

        tell_backend(backend)
        if self.at is not None:
            make_still(runs, self.at, output, look, backend, force=self.force)
        else:
            make_sheet(runs[0], output, look, backend, force=self.force)
        if self.json:
            told = {"output": str(output), "width": look.width, "height": look.height}
            print_json({**told, "backend": backend.name, "renderer": backend.renderer})
        else:
            print(f"still   {output}: {look.width}x{look.height}")
        return 0


def render(
    runs: "list[Run]",
    output: Path,
    look: "Look",
    backend: "Backend",
    *,
    fps: float = 30.0,
    speed: float = 1.0,
    force: Flag = False,
) -> "Made":
    """A video, with its progress on stderr; the first Ctrl-C ends it where it is."""
    from bikesim.view.timeline import frames_a_second
    from bikesim.view.video import make_video

    if not (math.isfinite(fps) and fps > 0):
        raise InputError(f"--fps {fps}: from 1 to 240 frames a second")
    tell_backend(backend)

    @contextmanager
    def watch(frames: int) -> "Iterator[Watch]":
        from bikesim.experiment.watch import Watch

        with Watch(frames, 1 / fps, unit="frame").watching() as watching:
            yield watching

    rate = frames_a_second(fps)
    return make_video(runs, output, look, backend, fps=rate, speed=speed, force=force, watch=watch)


def render_run(run: "Run", output: Path, *, force: bool) -> bool:
    """The video of a run that was just ridden; False, and a line on stderr, if there is none."""
    from bikesim.view.gl import find_backend
    from bikesim.view.quality import Quality
    from bikesim.view.video import Look

    if run.ending is not None and run.ending.reason == "interrupted":
        print("note: no video of an interrupted run; bikesim render makes it", file=sys.stderr)
        return False
    try:
        backend = find_backend()
    except InputError as error:
        print(f"note: no video: {error}", file=sys.stderr)
        return False
    look = Look(quality=Quality.DRAFT if backend.software else Quality.GOOD)
    render([run], output, look, backend, force=force)
    return True


def check_kind(output: Path, *, still: bool) -> None:
    """Refuse a suffix before any work. Raises InputError."""
    suffix = output.suffix.lower()
    stills, videos = (".png", ".jpg"), (".mp4", ".webm", ".gif")
    known = stills if still else videos
    if suffix in known:
        return
    hint = ""
    if suffix in stills:
        hint = "; a still has --at SECONDS or --sheet"
    if suffix in videos:
        hint = "; a video is made without --at and --sheet"
    what = "still" if still else "video"
    raise InputError(f"{output}: a {what} has the suffix {', '.join(known)}{hint}")


def parse_size(text: str) -> tuple[int, int]:
    """Width and height of "1280x720". Raises InputError."""
    found = re.fullmatch(r"\s*(\d{1,6})\s*[xX×]\s*(\d{1,6})\s*", text)
    if found is None:
        raise InputError(f"--size {text}: must be WIDTHxHEIGHT in pixels, such as 1280x720")
    return int(found[1]), int(found[2])


def tell_backend(backend: "Backend") -> None:
    """Which OpenGL draws, on stderr."""
    print(f"drawing with {backend.told}", file=sys.stderr)


def video_told(made: "Made") -> str:
    """A video in a line."""
    cut = "" if made.frames == made.planned else f", interrupted at {made.frames} of {made.planned}"
    return (
        f"video   {made.output}: {made.frames} frames{cut}, {made.seconds:.2f} s; "
        f"{made.render_time * 1e3:.1f} ms a frame"
    )


def video_json(made: "Made", look: "Look", backend: "Backend") -> dict[str, Any]:
    """The keys of `bikesim render --json`."""
    return {
        "output": str(made.output),
        "frames": made.frames,
        "planned_frames": made.planned,
        "interrupted": made.frames < made.planned,
        "seconds": made.seconds,
        "width": look.width,
        "height": look.height,
        "quality": look.quality.value,
        "render_time_per_frame_s": made.render_time,
        "processes": made.workers,
        "backend": backend.name,
        "renderer": backend.renderer,
        "software": backend.software,
    }


def _is_gif(path: Path) -> bool:
    return path.suffix.lower() == ".gif"
