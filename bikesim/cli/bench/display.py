"""bikesim bench display"""

import contextlib
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from bikesim.cli.bench.options import BenchName, arg
from bikesim.cli.parsing import Flag
from bikesim.errors import unknown

if TYPE_CHECKING:
    from bikesim.view.live.wanted import Wanted

_NICE = 10  # a ride's loop, and a person's own work, go before


@dataclass(frozen=True)
class Display:
    """Show the rides on a bench in a window: from the rider's eyes, from behind, or the bench.

    For a monitor or projector before the rider. Bicycle, path and what the scenario's [vision] lets
    him see come from the ride. Keys: F full screen, V next view, O figures on or off, Esc closes.
    """

    bench: BenchName
    view: Annotated[
        str,
        arg(
            "{first,second,bench}",
            "To begin with: from the rider's eyes, from behind, or the rig (default: first).",
        ),
    ] = "first"
    size: Annotated[str, arg("WxH", "Of the window in pixels (default: 1280x720).")] = "1280x720"
    full_screen: Flag = False
    """Fill the monitor."""
    monitor: Annotated[int | None, arg("N", "Which, from 1 (default: the main one).")] = None
    quality: Annotated[
        str | None,
        arg("{draft,good,best}", "As of bikesim render (default: good; draft without a GPU)."),
    ] = None
    no_overlay: Flag = False
    """No figures over the picture."""
    once: Flag = False
    """Close a little after the first ride is over."""

    def __call__(self) -> int:
        from bikesim.bench.display import ScreenReader, screen_name
        from bikesim.bench.profile import load_bench
        from bikesim.view.live.window import prepare_opengl

        wanted = self._wanted()
        bench = load_bench(self.bench)
        prepare_opengl()

        from bikesim.bench.onlooker import Onlooker
        from bikesim.view.live.display import LiveDisplay

        with contextlib.suppress(AttributeError, OSError):
            os.nice(_NICE)
        reader = ScreenReader(screen_name(bench.bus))
        try:
            LiveDisplay(Onlooker(reader), str(bench.bus), wanted, _told).run()
        finally:
            reader.close()
        return 0

    def _wanted(self) -> "Wanted":
        from bikesim.cli.render import parse_size
        from bikesim.view.layout import VIEWS
        from bikesim.view.live.wanted import Wanted, check_window_size
        from bikesim.view.quality import Quality

        if self.view not in VIEWS:
            raise unknown("--view", self.view, VIEWS)
        if self.quality is not None and self.quality not in set(Quality):
            raise unknown("--quality", self.quality, Quality)
        return Wanted(
            self.view,
            check_window_size(*parse_size(self.size)),
            self.monitor,
            self.full_screen,
            None if self.quality is None else Quality(self.quality),
            not self.no_overlay,
            self.once,
        )


def _told(line: str) -> None:
    print(line, flush=True)
