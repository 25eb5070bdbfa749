"""What the bicycle does, in memory that other processes can read: displays, and emulated riders.

The tick writes some numbers and goes on; whoever looks, looks when he likes. Nothing that a display
does, or fails to do, can delay a tick.
"""

import contextlib
import hashlib
import json
import os
import struct
import time
from multiprocessing import resource_tracker, shared_memory
from typing import Self

from bikesim.bench.bus import BusSettings
from bikesim.errors import InputError
from bikesim.model.haptic import BicycleState

_FIELDS = len(BicycleState._fields)
_COUNT = struct.Struct("<q")  # odd: a state is being written; _CLOSED: there will be none
_STATE = struct.Struct(f"<{_FIELDS}d")
_OWNER = struct.Struct("<qq")  # its process, and when the memory was made [ns]: no other ride's
_WORDS = struct.Struct("<512s")  # UTF-8, its end filled up with zeros
_ABOUT = struct.Struct("<q")  # length of a text, which follows
_OWNER_AT = _COUNT.size + _STATE.size
_WORDS_AT = _OWNER_AT + _OWNER.size
_ABOUT_AT = _WORDS_AT + _WORDS.size
_CLOSED = -1
_TRIES = 100
_STALE = 0.3  # s without a new state, and from one look for a newer ride to the next


def screen_name(bus: BusSettings) -> str:
    """Of the memory that goes with a bus: who knows the bus finds it."""
    text = json.dumps([bus.interface, bus.channel, bus.arguments], sort_keys=True)
    return f"bikesim-{hashlib.sha256(text.encode()).hexdigest()[:12]}"


class Screen:
    """Written by the ride. A sequence count, odd while a state is being written, goes before it."""

    def __init__(self, name: str, about: str = "") -> None:
        """`about`: what the ride says of itself, as `Showing.to_text` gives it.

        Raises InputError where another process rides. What a killed ride left is taken away.
        """
        _take_away(name)
        text = about.encode()
        size = _ABOUT_AT + _ABOUT.size + len(text)
        self._memory = shared_memory.SharedMemory(name, create=True, size=size)
        buffer = self._memory.buf
        assert buffer is not None
        self._buffer = buffer
        self._count = 0
        buffer[_ABOUT_AT + _ABOUT.size : size] = text
        _ABOUT.pack_into(buffer, _ABOUT_AT, len(text))
        _OWNER.pack_into(buffer, _OWNER_AT, os.getpid(), time.time_ns())

    def show(self, bicycle: BicycleState) -> None:
        """Costs a microsecond."""
        buffer, count = self._buffer, self._count
        _COUNT.pack_into(buffer, 0, count + 1)
        _STATE.pack_into(buffer, _COUNT.size, *bicycle)
        self._count = count + 2
        _COUNT.pack_into(buffer, 0, count + 2)

    def stand(self, words: str) -> None:
        """There is nothing to see any more but a bicycle that stands upright, and these words."""
        self.say(words)
        self._count = 0
        _COUNT.pack_into(self._buffer, 0, 0)

    def say(self, words: str) -> None:
        """What goes on, in a line; not from a tick."""
        _WORDS.pack_into(self._buffer, _WORDS_AT, words.encode()[: _WORDS.size])

    def close(self) -> None:
        """Nobody can look any more who does not already; who does sees that it is over."""
        _COUNT.pack_into(self._buffer, 0, _CLOSED)
        self._buffer.release()
        self._memory.close()
        with contextlib.suppress(FileNotFoundError):
            self._memory.unlink()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if error is not None:
            self.say(str(error) or "interrupted")
        self.close()


class ScreenReader:
    """Looks at a screen, if there is one by now; when a ride is over, at the next one's."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._memory: shared_memory.SharedMemory | None = None
        self._count, self._changed, self._tried = 0, 0.0, 0.0
        self._last_words = ""

    def look(self) -> tuple[int, BicycleState] | None:
        """The newest state with its count, which rises from one to the next; None: nothing yet."""
        if self._memory is None and not self._find():
            return None
        seen = self._read()
        if seen is not None and seen[0] != self._count:
            self._count, self._changed = seen[0], time.monotonic()
        elif self._memory is not None:
            self._look_for_a_newer()
        return seen

    @property
    def ride(self) -> int | None:
        """A number that no other ride has; None where no screen is looked at."""
        return None if self._memory is None else _owner(self._memory)[1]

    @property
    def alive(self) -> bool:
        """Whether the process that is to write this screen runs."""
        return self._memory is not None and _runs(_owner(self._memory)[0])

    @property
    def standing(self) -> bool:
        """Whether the bicycle stands: before a ride's first state, or when it fell."""
        return self._memory is not None and _COUNT.unpack_from(_buffer(self._memory)) == (0,)

    @property
    def about(self) -> str:
        """What the ride says of itself."""
        if self._memory is None:
            return ""
        buffer = _buffer(self._memory)
        (length,) = _ABOUT.unpack_from(buffer, _ABOUT_AT)
        begin = _ABOUT_AT + _ABOUT.size
        return bytes(buffer[begin : begin + length]).decode()

    @property
    def words(self) -> str:
        """What was said last, also of a ride that is over."""
        if self._memory is not None:
            (text,) = _WORDS.unpack_from(_buffer(self._memory), _WORDS_AT)
            self._last_words = text.rstrip(b"\0").decode(errors="replace")
        return self._last_words

    def close(self) -> None:
        if self._memory is not None:
            self._last_words = self.words
            self._memory.close()
            self._memory = None

    def _read(self) -> tuple[int, BicycleState] | None:
        assert self._memory is not None
        buffer = _buffer(self._memory)
        for _ in range(_TRIES):
            (before,) = _COUNT.unpack_from(buffer)
            values = _STATE.unpack_from(buffer, _COUNT.size)
            (after,) = _COUNT.unpack_from(buffer)
            if before == _CLOSED:
                self.close()
                return None
            if before == after and before % 2 == 0:
                return (before, BicycleState._make(values)) if before else None
        return None

    def _find(self) -> bool:
        memory = _opened(self._name)
        if memory is None:
            return False
        self._memory = memory
        self._count, self._changed = 0, time.monotonic()
        return True

    def _look_for_a_newer(self) -> None:
        """A ride that was killed does not say that it is over."""
        now = time.monotonic()
        if now - self._changed < _STALE or now - self._tried < _STALE:
            return
        self._tried = now
        newer = _opened(self._name)
        if newer is not None and _owner(newer)[1] != self.ride:
            self.close()
            self._memory, self._count, self._changed = newer, 0, now
        elif newer is not None:
            newer.close()


def _opened(name: str) -> shared_memory.SharedMemory | None:
    """To look at; None where there is none, or one that is not ready to be looked at."""
    try:
        memory = shared_memory.SharedMemory(name)
    except (FileNotFoundError, ValueError):
        return None
    whole = memory.size >= _ABOUT_AT + _ABOUT.size
    if not whole or _owner(memory)[0] != os.getpid():
        # Else this process would remove it at its end, as if it had made it.
        resource_tracker.unregister(f"/{memory.name}", "shared_memory")
    if not whole or not _owner(memory)[1]:
        memory.close()
        return None
    return memory


def _take_away(name: str) -> None:
    """What a killed ride left; who still looks at it sees that it is over. Raises InputError."""
    try:
        memory = shared_memory.SharedMemory(name)
    except (FileNotFoundError, ValueError):
        return
    try:
        if memory.size >= _ABOUT_AT:
            process = _owner(memory)[0]
            if process != os.getpid() and _runs(process):
                resource_tracker.unregister(f"/{memory.name}", "shared_memory")
                raise InputError(f"a ride is on this bus already: process {process}")
        _COUNT.pack_into(_buffer(memory), 0, _CLOSED)
        with contextlib.suppress(FileNotFoundError):
            memory.unlink()
    finally:
        memory.close()


def _buffer(memory: shared_memory.SharedMemory) -> memoryview:
    assert memory.buf is not None
    return memory.buf


def _owner(memory: shared_memory.SharedMemory) -> tuple[int, int]:
    """The process, and when it made the memory [ns]; zeros while it does."""
    return _OWNER.unpack_from(_buffer(memory), _OWNER_AT)


def _runs(process: int) -> bool:
    if process <= 0:
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return True
