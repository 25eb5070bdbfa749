"""What `bench check` finds, a line of its table each."""

from typing import NamedTuple


class Finding(NamedTuple):
    """A line of the table."""

    good: bool
    what: str
    found: str
    wanted: str
