"""The live display of rides on a bench: what the rider sees, or that there is nothing to see."""

import time
from collections.abc import Callable

from bikesim.bench.onlooker import Onlooker, Phase, Sight
from bikesim.bench.showing import Showing
from bikesim.model.haptic import BicycleState
from bikesim.view.drawing import INK
from bikesim.view.gl import is_software
from bikesim.view.layout import VIEWS
from bikesim.view.live.eyes import Eyes
from bikesim.view.live.messages import Corners, Figures, Message, message
from bikesim.view.live.picture import Sheet
from bikesim.view.live.stage import Size, Stage
from bikesim.view.live.wanted import Wanted
from bikesim.view.live.window import Window
from bikesim.view.live.words import fitting, plate
from bikesim.view.pose import Pose
from bikesim.view.quality import Quality

_DIM = 0.62  # of the light taken from a picture that is not live
_WIDTH = 170  # of the plate with the figures, in pixels of a 720p picture
_LINGER = 4.0  # s that the end of a ride stands
_STANDING = Pose(0, 0, 0, 0, 0, 0, 0, 0)


class LiveDisplay:
    """A window that shows ride after ride until it is closed."""

    def __init__(
        self, onlooker: Onlooker, where: str, wanted: Wanted, tell: Callable[[str], object]
    ) -> None:
        """`where`: the bus, in words; `tell`: once for each ride, when it can be seen."""
        self._onlooker, self._where, self._wanted, self._tell = onlooker, where, wanted, tell
        self._view, self._overlay = wanted.view, wanted.overlay
        self.frames = 0
        self._window = Window(
            wanted.size, wanted.monitor, full_screen=wanted.full_screen, press=self.press
        )
        try:
            self._window.title(where)
            self._sheet = Sheet()
            self.renderer = self._window.renderer
        except BaseException:
            self._window.close()
            raise
        default = Quality.DRAFT if is_software(self.renderer) else Quality.GOOD
        self._quality = wanted.quality or default
        self._showing: Showing | None = None
        self._stage: Stage | None = None
        self._eyes = Eyes(0.0, ())
        self._figures: Figures | None = None
        self._over_since: float | None = None

    def run(self) -> None:
        """Until the window is closed."""
        try:
            while not self._window.closed and not self._lingered():
                self._frame()
        finally:
            self._window.close()

    def press(self, key: str) -> None:
        """V: the next view; O: what is written over it, or not."""
        if key == "v":
            self._view = VIEWS[(VIEWS.index(self._view) + 1) % len(VIEWS)]
        elif key == "o":
            self._overlay = not self._overlay

    def _frame(self) -> None:
        began = time.monotonic()
        size = self._window.size
        sight = self._onlooker.look(began)
        if self._onlooker.showing is not self._showing and min(size) > 0:
            self._begin(size)
        if min(size) > 0:
            self._draw(sight, size)
        over = sight.phase in (Phase.OVER, Phase.SILENT)
        self._over_since = (self._over_since or began) if over else None
        self._window.swap()
        self.frames += 1
        # Where no monitor sets the pace.
        period = 1 / self._window.refresh_rate
        if (left := period - (time.monotonic() - began)) > 0.2 * period:
            time.sleep(left)

    def _lingered(self) -> bool:
        since = self._over_since
        return self._wanted.once and since is not None and time.monotonic() - since > _LINGER

    def _begin(self, size: Size) -> None:
        """Of a ride: its scene, which takes a while."""
        self._say(Message("a ride begins", "its scene is being made"), size)
        self._window.swap()
        if self._stage is not None:
            self._stage.close()
        showing = self._onlooker.showing
        assert showing is not None
        self._stage = Stage(showing, size, self._quality)
        self._eyes, self._figures = Eyes(showing.delay, showing.occlusions), Figures(showing)
        self._stage.draw(self._view, _STANDING, _STANDING, size)
        self._showing = showing
        width, height = size
        self._tell(f"ready: {width}x{height}, {self._quality} on {self.renderer}")

    def _draw(self, sight: Sight, size: Size) -> None:
        if self._stage is None or self._figures is None:
            self._say(Message(f"waiting for a ride on {self._where}"), size)
            return
        pose = _STANDING if sight.state is None else _pose(sight.state)
        drawn = self._stage.draw(self._view, pose, self._eyes.see(pose), size)
        if not drawn:
            self._sheet.fill(size, (0, 0, 0))
        elif self._overlay and sight.state is not None:
            self._write(self._figures.at(sight.state), size)
        if (said := message(sight)) is not None:
            self._say(said, size, over=sight.phase is not Phase.READY)

    def _write(self, corners: Corners, size: Size) -> None:
        unit = _unit(size)
        margin = round(16 * unit)
        self._sheet.put(plate(corners.left, unit, least=_WIDTH), margin, margin, size)
        picture = plate(corners.right, unit)
        self._sheet.put(picture, size[0] - picture.shape[1] - margin, margin, size)

    def _say(self, said: Message, size: Size, *, over: bool | None = None) -> None:
        """In the middle; `over` a picture that is dimmed or not, None: on an empty sheet."""
        if over is None:
            self._sheet.fill(size, INK)
        elif over:
            self._sheet.fill(size, (0, 0, 0), _DIM)
        picture = fitting(said.lines, _unit(size), size)
        x, y = max(0, (size[0] - picture.shape[1]) // 2), round(0.30 * size[1])
        self._sheet.put(picture, x, y, size)


def _unit(size: Size) -> float:
    """Pixels of a window for one of a 720p picture."""
    return max(0.4, min(size[1] / 720, size[0] / 960))


def _pose(state: BicycleState) -> Pose:
    return Pose(
        *(
            float(one)
            for one in (
                state.time, state.speed, state.roll, state.steer,
                state.heading, state.x, state.y, state.distance,
            )
        )
    )  # fmt: skip
