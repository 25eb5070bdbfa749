"""Two SLCAN adapters (Lawicel's protocol) at one CAN bus, each a pseudo-terminal; a process.

It prints the names of the two lines. "cut" on its standard input parts them, the bus's cable; with
"unplug" the first adapter disappears; with "hang" it stops reading.
"""

import contextlib
import os
import select
import sys
import tty

FRAMES = b"trTR"


class Adapter:
    """One end: closed until it is opened; frames pass only between two of the same bit rate."""

    def __init__(self) -> None:
        self.file, self._line = os.openpty()
        tty.setraw(self._line)  # held open, or there would be a hangup between two users of it
        os.set_blocking(self.file, False)
        self.name = os.ttyname(self._line)
        self.open, self.bitrate = False, b""
        self._read = b""

    def frames(self) -> list[bytes]:
        """What was sent into it since; commands are done and answered."""
        *lines, self._read = (self._read + os.read(self.file, 65536)).split(b"\r")
        return [line for line in lines if self._is_frame(line)]

    def _is_frame(self, line: bytes) -> bool:
        kind = line[:1]
        if kind in FRAMES and kind:
            self.answer(b"z\r" if self.open else b"\a")
            return self.open
        if kind == b"S" and not self.open:
            self.bitrate = line
        elif kind in (b"O", b"C"):
            self.open = kind == b"O"
        self.answer(b"\r")
        return False

    def answer(self, said: bytes) -> None:
        with contextlib.suppress(BlockingIOError):  # nobody reads there: the rest is lost
            os.write(self.file, said)

    def unplug(self) -> None:
        os.close(self.file)
        os.close(self._line)


def carry(sender: Adapter, receiver: Adapter) -> None:
    for frame in sender.frames():
        if receiver.open and receiver.bitrate == sender.bitrate:
            receiver.answer(frame + b"\r")


def main() -> None:
    ours, theirs = Adapter(), Adapter()
    print(ours.name, theirs.name, flush=True)
    ends = {ours.file: (ours, theirs), theirs.file: (theirs, ours)}
    cut = False
    while True:
        readable, _, _ = select.select([sys.stdin, *ends], [], [])
        for file in readable:
            if file is sys.stdin:
                command = sys.stdin.readline().strip()
                if not command:
                    return
                cut = True
                if command != "cut":
                    ends.pop(ours.file)
                if command == "unplug":
                    ours.unplug()
            elif file in ends:
                sender, receiver = ends[file]
                if cut:
                    sender.frames()
                else:
                    carry(sender, receiver)


if __name__ == "__main__":
    main()
