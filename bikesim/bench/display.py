"""What the bicycle does, in memory that other processes can read: displays, and emulated riders.

The tick writes some numbers and goes on; whoever looks, looks when he likes. Nothing that a display
does, or fails to do, can delay a tick.
"""

import contextlib
import hashlib
import json
import struct
from multiprocessing import resource_tracker, shared_memory
from typing import Self

from bikesim.bench.bus import BusSettings
from bikesim.model.haptic import BicycleState

_FIELDS = len(BicycleState._fields)
_COUNT = struct.Struct("<q")
_STATE = struct.Struct(f"<{_FIELDS}d")
_SIZE = _COUNT.size + _STATE.size
_TRIES = 100


def screen_name(bus: BusSettings) -> str:
    """Of the memory that goes with a bus: who knows the bus finds it."""
    text = json.dumps([bus.interface, bus.channel, bus.arguments], sort_keys=True)
    return f"bikesim-{hashlib.sha256(text.encode()).hexdigest()[:12]}"


class Screen:
    """Written by the ride. A sequence count, odd while a state is being written, goes before it."""

    def __init__(self, name: str) -> None:
        # One that a killed ride left is taken over.
        try:
            self._memory = shared_memory.SharedMemory(name, create=True, size=_SIZE)
        except FileExistsError:
            self._memory = shared_memory.SharedMemory(name)
        buffer = self._memory.buf
        assert buffer is not None
        self._buffer = buffer
        (count,) = _COUNT.unpack_from(self._buffer)
        self._count = count + count % 2

    def show(self, bicycle: BicycleState) -> None:
        """Costs a microsecond."""
        buffer, count = self._buffer, self._count
        _COUNT.pack_into(buffer, 0, count + 1)
        _STATE.pack_into(buffer, _COUNT.size, *bicycle)
        self._count = count + 2
        _COUNT.pack_into(buffer, 0, count + 2)

    def close(self) -> None:
        """Nobody can look any more who does not already."""
        self._buffer.release()
        self._memory.close()
        with contextlib.suppress(FileNotFoundError):
            self._memory.unlink()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class ScreenReader:
    """Looks at a screen, if there is one by now."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._memory: shared_memory.SharedMemory | None = None

    def look(self) -> tuple[int, BicycleState] | None:
        """The newest state with its count, which rises from one to the next; None: nothing yet."""
        if self._memory is None and not self._find():
            return None
        assert self._memory is not None
        buffer = self._memory.buf
        assert buffer is not None
        for _ in range(_TRIES):
            (before,) = _COUNT.unpack_from(buffer)
            values = _STATE.unpack_from(buffer, _COUNT.size)
            (after,) = _COUNT.unpack_from(buffer)
            if before == after and before % 2 == 0:
                return (before, BicycleState._make(values)) if before else None
        return None

    def close(self) -> None:
        if self._memory is not None:
            self._memory.close()
            self._memory = None

    def _find(self) -> bool:
        try:
            memory = shared_memory.SharedMemory(self._name)
        except (FileNotFoundError, ValueError):
            return False
        # Else this process would remove it at its end, as if it had made it.
        resource_tracker.unregister(f"/{memory.name}", "shared_memory")
        self._memory = memory
        return True
