"""Frames into a video file: H.264 in MP4, VP9 in WebM, or an animated GIF."""

from fractions import Fraction
from pathlib import Path
from typing import Protocol

import av
import numpy as np
from av.video.reformatter import ColorPrimaries, ColorRange, Colorspace, ColorTrc
from numpy.typing import NDArray

from bikesim.errors import InputError, unknown
from bikesim.view.quality import Quality
from bikesim.view.timeline import CLOCK

Pixels = NDArray[np.uint8]

# The same frames give the same file only if the encoder is cut up in the same way. Drafts are
# drawn on all cores while they are encoded, and one thread costs least.
_THREADS = {Quality.DRAFT: "1", Quality.GOOD: "4", Quality.BEST: "4"}

_H264 = {
    # A constant QP needs no look at each frame beforehand: a fifth less work at the same size.
    Quality.DRAFT: {"preset": "ultrafast", "qp": "24"},
    Quality.GOOD: {"preset": "veryfast", "crf": "20"},
    Quality.BEST: {"preset": "slow", "crf": "17"},
}
_VP9 = {
    Quality.DRAFT: {"deadline": "realtime", "cpu-used": "8", "crf": "36"},
    Quality.GOOD: {"deadline": "good", "cpu-used": "5", "crf": "31"},
    Quality.BEST: {"deadline": "good", "cpu-used": "2", "crf": "26"},
}

SUFFIXES = (".mp4", ".webm", ".gif")


class Encoder(Protocol):
    """Writes frames; a context manager that closes the file so that it can be played."""

    pixels: str

    def write(self, frame: Pixels, tick: int) -> None:
        """A frame, shown at `tick` / CLOCK s. Raises OSError."""
        ...

    def close(self) -> None:
        """Raises OSError."""
        ...


def suffix_of(path: Path) -> str:
    """The suffix of a video that we can write. Raises InputError."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        if not suffix:
            raise InputError(f"{path}: name a video {', '.join(SUFFIXES)}")
        raise unknown(f"kind of video ({', '.join(SUFFIXES)})", suffix, SUFFIXES)
    return suffix


class VideoEncoder:
    """H.264 or VP9, 4:2:0, BT.709."""

    pixels = "yuv420p"

    def __init__(
        self, path: Path, kind: str, width: int, height: int, fps: Fraction, quality: Quality
    ) -> None:
        """`kind` is "mp4" or "webm"; width and height are even. Raises OSError, InputError."""
        options = {"movflags": "+faststart"} if kind == "mp4" else {}
        self._container = av.open(str(path), "w", format=kind, container_options=options)
        self._container.flags |= 0x0400  # bit exact: no date, no versions
        codec, settings = _codec(kind, quality)
        stream = self._container.add_stream(codec, rate=fps, options=settings)
        assert isinstance(stream, av.VideoStream)
        self._stream, context = stream, stream.codec_context
        context.width, context.height, context.pix_fmt = width, height, self.pixels
        context.time_base = Fraction(1, CLOCK)
        context.thread_count = int(_THREADS[quality])
        context.colorspace = Colorspace.ITU709
        context.color_range = ColorRange.MPEG
        context.color_primaries = ColorPrimaries.BT709
        context.color_trc = ColorTrc.BT709
        try:
            context.open()
        except (ValueError, OSError) as error:
            self._container.close()
            raise InputError(
                f"--size {width}x{height}: the encoder of .{kind} refuses it"
            ) from error

    def write(self, frame: Pixels, tick: int) -> None:
        made = av.VideoFrame.from_ndarray(frame, format=self.pixels)
        made.pts, made.time_base = tick, Fraction(1, CLOCK)
        self._container.mux(self._stream.encode(made))

    def close(self) -> None:
        self._container.mux(self._stream.encode(None))
        self._container.close()


def _codec(kind: str, quality: Quality) -> tuple[str, dict[str, str]]:
    if kind == "mp4":
        # A key frame every 2 s at 30 fps lets a talk jump to any place.
        return "libx264", {**_H264[quality], "g": "60", "threads": _THREADS[quality]}
    settings = {"b": "0", "g": "120", "row-mt": "1", "threads": _THREADS[quality]}
    return "libvpx-vp9", {**_VP9[quality], **settings}
