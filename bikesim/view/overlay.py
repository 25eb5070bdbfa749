"""What is written over the pictures of a run: time, speed, haptics, lean, torque, the fall."""

from collections.abc import Sequence

import numpy as np

from bikesim.view.canvas import Canvas
from bikesim.view.drawing import BOLD, WHITE, text_width, write
from bikesim.view.gauges import Clock, Gauge, Haptics, LeanDial, TorqueBar, text_size
from bikesim.view.layout import Box
from bikesim.view.reel import Moment, Reel
from bikesim.view.strip import nice

_ENDED_LIGHT = 0.55
_TAG = (196, 70, 20)


class Overlay:
    """Draws over the pictures of one run; `unit` is a pixel of a 720p video in those of this."""

    def __init__(
        self, reel: Reel, area: Box, unit: float, *, lean: bool, torque_scale: float
    ) -> None:
        """`lean`: whether the lean indicator is shown; `torque_scale` [N m]: end of the bar."""
        self._reel, self._area, self._unit = reel, area, unit
        self._gauges: list[Gauge] = [Clock(reel, area, unit), Haptics(reel, area, unit)]
        if lean:
            self._gauges.append(LeanDial(area, unit))
        self._gauges.append(TorqueBar(reel, area, unit, torque_scale))

    def draw(self, canvas: Canvas, moment: Moment, time: float) -> None:
        """Over the pictures of the run at a time of the video [s], which may be past its end."""
        ended = self._reel.ended(time)
        if ended:
            canvas.darken(self._area, _ENDED_LIGHT)
        for gauge in self._gauges:
            gauge.draw(canvas, moment)
        if ended:
            self._draw_ending(canvas)

    def _draw_ending(self, canvas: Canvas) -> None:
        u, area, text = self._unit, self._area, self._reel.end_text
        size = text_size(46, u)
        width, height = text_width(text, size, BOLD) + 56 * u, 78 * u
        y = 0.34 * area.height - height / 2
        box = Box.about((area.width - width) / 2, y, width, height, area)
        canvas.fill(box, _TAG)
        with canvas.drawing(box) as part:
            at = area.x + area.width / 2 - box.x, area.y + y + 55 * u - box.y
            write(part, text, *at, size, WHITE, BOLD, "middle")


def torque_scale(reels: Sequence[Reel]) -> float:
    """A round end of the torque bar that all these runs stay within [N m]."""
    return nice(max(0.5, *(1.1 * float(np.abs(reel.curves.feedback).max()) for reel in reels)))
