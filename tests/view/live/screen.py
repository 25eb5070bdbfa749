"""A monitor that is not there, Xvfb, and what stands on it."""

import os
import struct
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

SIZE = (640, 360)

Picture = NDArray[np.uint8]


class Monitor:
    """One of `SIZE`; `display` is what DISPLAY calls it."""

    def __init__(self, display: str, memory: Path) -> None:
        self.display = display
        self._memory = memory

    @property
    def environment(self) -> dict[str, str]:
        """For a process that is to draw on it."""
        kept = {k: v for k, v in os.environ.items() if not k.startswith(("WAYLAND_", "MUJOCO_"))}
        return kept | {"DISPLAY": self.display, "XDG_SESSION_TYPE": "x11"}

    def picture(self) -> Picture:
        """What is on it, RGB; the file is laid out as by xwd(1)."""
        data = self._memory.read_bytes()
        header = struct.unpack(">25I", data[:100])
        size, width, height, line, colours = (header[k] for k in (0, 4, 5, 12, 19))
        pixels = np.frombuffer(data, np.uint8, height * line, size + 12 * colours)
        return pixels.reshape(height, line)[:, : 4 * width].reshape(height, width, 4)[..., 2::-1]

    def until(self, good: Callable[[Picture], object], seconds: float = 120.0) -> Picture:
        """Waits for a picture of which that is true."""
        deadline = time.monotonic() + seconds
        while not good(picture := self.picture()):
            assert time.monotonic() < deadline, "the window never showed it"
            time.sleep(0.05)
        return picture


@contextmanager
def monitor(folder: Path) -> Iterator[Monitor]:
    """Xvfb, from the Debian package of that name."""
    read, write = os.pipe()
    width, height = SIZE
    command = [
        "Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24",
        "-fbdir", str(folder), "-nolisten", "tcp", "-noreset",
    ]  # fmt: skip
    with subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL) as server:
        os.close(write)
        try:
            with os.fdopen(read) as said:
                number = said.readline().strip()
            assert number, "Xvfb did not start"
            yield Monitor(f":{number}", folder / "Xvfb_screen0")
        finally:
            server.terminate()
