"""How far a reproduction is, on stderr."""

import sys
from typing import Self

from tqdm import tqdm


class Progress:
    """Counts steps, with a bar where stderr is a terminal; a context manager."""

    def __init__(self, steps: int) -> None:
        self._bar = tqdm(total=steps, leave=False, file=sys.stderr, disable=not sys.stderr.isatty())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self._bar.close()

    def step(self, what: str) -> None:
        """One step done; `what` names the work in hand."""
        self._bar.set_description(what, refresh=False)
        self._bar.update()
