"""A display started with a ride: a process of its own, which a loop never waits for."""

import queue
import subprocess
import threading
import time
from collections.abc import Callable
from typing import Self

from bikesim.child import child_command

READY = "ready"
"""With this word begins what `bikesim bench display` prints when a ride can be seen."""

_PATIENCE = 30.0  # s for its scene, on a slow computer


class DisplayProcess:
    """`bikesim bench display PROFILE --once`; a context manager about a ride.

    Entered before anything is on the bus: there it is waited for until the rider can see the road,
    so that nobody rides blind. Afterwards nobody looks whether it lives. What it cannot do is said
    in a line, and the ride goes on without.
    """

    def __init__(self, bench: str, say: Callable[[str], object]) -> None:
        """`bench` as `load_bench` takes it."""
        self._bench, self._say = bench, say

    def __enter__(self) -> Self:
        process = subprocess.Popen(
            child_command("bikesim", "bench", "display", self._bench, "--once"),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            # Ctrl-C in a terminal is the ride's; this one sees that the ride is over.
            start_new_session=True,
        )
        try:
            self._say(f"display  {self._waited_for(process)}")
        except BaseException:
            process.kill()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """It shows how the ride ended, and closes by itself."""

    def _waited_for(self, process: subprocess.Popen[str]) -> str:
        """What it says: that it is ready, or why it is not."""
        lines: queue.Queue[str] = queue.Queue()
        threading.Thread(target=_read, args=(process, lines), daemon=True).start()
        last, end = "", time.monotonic() + _PATIENCE
        while (left := end - time.monotonic()) > 0:
            try:
                line = lines.get(timeout=left)
            except queue.Empty:
                break
            if line.startswith(READY):
                return line
            if not line:
                return f"none, the ride goes on without: {_why(last)}"
            last = line
        return f"not ready after {_PATIENCE:g} s; the ride goes on"


def _read(process: subprocess.Popen[str], lines: queue.Queue[str]) -> None:
    """Its lines up to the one that says it is ready; an empty one if it ends before."""
    assert process.stdout is not None
    for line in process.stdout:
        lines.put(line.strip() or "-")
        if line.startswith(READY):
            return
    lines.put("")


def _why(line: str) -> str:
    return line.removeprefix("bikesim: ").removeprefix("display: ")
