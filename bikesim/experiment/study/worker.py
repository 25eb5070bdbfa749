"""A process that does what comes through its connection, one thing after another.

`python -m bikesim.experiment.study.worker FILE-DESCRIPTOR`. It ends when nobody is there any more.
"""

import os
import sys
from contextlib import suppress
from multiprocessing.connection import Connection

from bikesim.experiment.study.work import Order, Progress, work


def main(connection: Connection) -> None:
    """Answer each order, with its progress before; anything that comes meanwhile ends it."""
    # What a rider of the user's prints must not get lost, nor among what we print.
    with suppress(OSError):
        os.dup2(2, 1)

    def report(fraction: float) -> bool:
        connection.send(Progress(fraction))
        return connection.poll()

    while (order := connection.recv()) is not None:
        assert isinstance(order, Order)
        connection.send(work(order, report))


if __name__ == "__main__":
    # Whoever gave the orders has gone, and with him whoever wanted the answers.
    with suppress(EOFError, ConnectionError), Connection(int(sys.argv[1])) as pipe:
        main(pipe)
