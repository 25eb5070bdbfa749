"""Frames into an animated GIF with one palette for all of them."""

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from av.filter import Graph
from av.filter.context import FilterContext
from av.video.format import VideoFormat
from numpy.typing import NDArray

from bikesim.view.timeline import CLOCK

Pixels = NDArray[np.uint8]

_HUNDREDTHS = 100  # the clock of a GIF [1/s]
_CLOCK = Fraction(1, _HUNDREDTHS)
_LAST_FRAME = 150  # stays so long before the loop begins again [1/100 s]


class GifEncoder:
    """A GIF that loops."""

    pixels = "rgb24"

    def __init__(
        self, path: Path, width: int, height: int, fps: Fraction, samples: Iterable[Pixels]
    ) -> None:
        """`samples`: frames that have all colours of the video. Raises OSError."""
        palette = _palette(samples, width, height)
        # The graph is kept: its ends do not keep it alive.
        self._graph, self._source, self._sink = _use_palette(palette, width, height)
        options = {"final_delay": str(_LAST_FRAME)}
        self._container = av.open(str(path), "w", format="gif", options=options)
        stream = self._container.add_stream("gif", rate=fps)
        assert isinstance(stream, av.VideoStream)
        self._stream, context = stream, stream.codec_context
        context.width, context.height, context.pix_fmt = width, height, "pal8"
        context.time_base = _CLOCK
        self._last = -1

    def write(self, frame: Pixels, tick: int) -> None:
        """A frame, shown at `tick` / CLOCK s, to a hundredth. Raises OSError."""
        made = av.VideoFrame.from_ndarray(frame, format="rgb24")
        self._last = max(self._last + 1, round(tick * _HUNDREDTHS / CLOCK))
        made.pts, made.time_base = self._last, _CLOCK
        self._source.push(made)
        paletted = self._sink.pull()
        assert isinstance(paletted, av.VideoFrame)
        self._container.mux(self._stream.encode(paletted))

    def close(self) -> None:
        """Raises OSError."""
        self._container.mux(self._stream.encode(None))
        self._container.close()


def _palette(samples: Iterable[Pixels], width: int, height: int) -> av.VideoFrame:
    graph = Graph()
    source = graph.add_buffer(
        width=width, height=height, format=VideoFormat("rgb24"), time_base=_CLOCK
    )
    graph.link_nodes(
        source, graph.add("palettegen", "reserve_transparent=0"), graph.add("buffersink")
    )
    graph.configure()
    for i, sample in enumerate(samples):
        frame = av.VideoFrame.from_ndarray(sample, format="rgb24")
        frame.pts, frame.time_base = i, _CLOCK
        graph.vpush(frame)
    graph.vpush(None)
    return graph.vpull()


def _use_palette(
    palette: av.VideoFrame, width: int, height: int
) -> tuple[Graph, FilterContext, FilterContext]:
    """A graph, where RGB frames go in, and where they come out with the palette."""
    graph = Graph()
    frames = graph.add_buffer(
        width=width, height=height, format=VideoFormat("rgb24"), time_base=_CLOCK
    )
    colours = graph.add_buffer(
        width=palette.width, height=palette.height, format=palette.format, time_base=_CLOCK
    )
    # An ordered pattern stands still where the picture does, and so packs better than noise.
    use = graph.add("paletteuse", "dither=bayer:bayer_scale=4:diff_mode=rectangle")
    frames.link_to(use, 0, 0)
    colours.link_to(use, 0, 1)
    sink = graph.add("buffersink")
    use.link_to(sink)
    graph.configure()
    palette.pts, palette.time_base = 0, _CLOCK
    colours.push(palette)
    colours.push(None)
    return graph, frames, sink
