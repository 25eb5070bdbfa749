"""The processes that draw: each with its own OpenGL, their frames handed on in order."""

import contextlib
import os
import pickle
import subprocess
from collections.abc import Iterator, Sequence
from typing import IO, Self

import numpy as np
from numpy.typing import NDArray

from bikesim.child import child_command
from bikesim.errors import InputError
from bikesim.view.film import Film
from bikesim.view.gl import Backend
from bikesim.view.order import FRAME, Order

try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None

Pixels = NDArray[np.uint8]

# Each takes some 350 MB, and software OpenGL has threads of its own for further cores.
_MOST_WORKERS = 2
_PIPE = 1 << 20  # bytes, the most that Linux allows any user


def cores() -> int:
    """Those that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def workers_for(frames: int) -> int:
    """How many processes draw so many frames."""
    return max(1, min(_MOST_WORKERS, cores(), frames))


class Crew:
    """Workers that make frames of a film; a context manager.

    Worker i of n makes every n-th frame from the i-th on and then waits in its pipe until it is
    read: frames come in order, and no more than a few are ever held.
    """

    def __init__(self, film: Film, frames: Sequence[int], pixels: str, backend: Backend) -> None:
        self._shape = _shape(film, pixels)
        self._count = len(frames)
        self.workers = workers_for(len(frames))
        threads = max(1, cores() // self.workers)
        self._processes: list[subprocess.Popen[bytes]] = []
        try:
            for i in range(self.workers):
                order = Order(film, tuple(frames[i :: self.workers]), pixels)
                self._start(order, backend.environment(threads))
        except BaseException:
            self.close()
            raise

    def _start(self, order: Order, environment: dict[str, str]) -> None:
        process = subprocess.Popen(
            child_command("bikesim.view.worker"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
            # Ctrl-C in a terminal is for us alone, who close the file.
            start_new_session=True,
        )
        self._processes.append(process)
        _widen(process.stdout)
        stdin = process.stdin
        assert stdin is not None
        with stdin:
            pickle.dump(order, stdin, protocol=pickle.HIGHEST_PROTOCOL)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def frames(self) -> Iterator[Pixels]:
        """All frames in order; each only valid until the next. Raises InputError."""
        pixels = np.empty(self._shape, np.uint8)
        for i in range(self._count):
            self._receive(self._processes[i % self.workers], pixels)
            yield pixels

    def _receive(self, process: subprocess.Popen[bytes], pixels: Pixels) -> None:
        pipe = process.stdout
        assert pipe is not None
        kind = pipe.read(1)
        if kind == FRAME and _fill(pipe, pixels):
            return
        if kind in (b"", FRAME):
            raise InputError(f"a drawing process ended with status {process.wait()}")
        raise InputError(pipe.read().decode(errors="replace"))

    def close(self) -> None:
        """End the workers, whatever they are doing."""
        for process in self._processes:
            process.kill()
        for process in self._processes:
            if process.stdout is not None:
                process.stdout.close()
            process.wait()


def _shape(film: Film, pixels: str) -> tuple[int, ...]:
    height, width = film.layout.height, film.layout.width
    return (height, width, 3) if pixels == "rgb24" else (height * 3 // 2, width)


def _widen(pipe: IO[bytes] | None) -> None:
    """Lets a pipe hold most of a frame, where the system can: fewer turns between the processes."""
    if fcntl is not None and pipe is not None and hasattr(fcntl, "F_SETPIPE_SZ"):
        with contextlib.suppress(OSError):
            fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, _PIPE)


def _fill(pipe: IO[bytes], pixels: Pixels) -> bool:
    left = memoryview(pixels.reshape(-1).data)
    while left:
        got = pipe.readinto(left)  # pyright: ignore[reportAttributeAccessIssue]
        if not got:
            return False
        left = left[got:]
    return True
