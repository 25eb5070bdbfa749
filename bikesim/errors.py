"""What a user did that cannot be done, said in one line."""

import difflib
from collections.abc import Iterable


class InputError(Exception):
    """Bad input: the message is one line with what is wrong, where, and what is allowed.

    The command line prints it and exits with status 2; a library user catches it.
    """


def unknown(kind: str, name: str, known: Iterable[str]) -> InputError:
    """The error for a name that is not among the known ones, naming the near ones."""
    by_lower = {text.lower(): text for text in known}
    near = difflib.get_close_matches(name.lower(), by_lower, n=3, cutoff=0.5)
    hint = (
        f"did you mean {' or '.join(by_lower[text] for text in near)}?"
        if near
        else f"known: {_listed(list(by_lower.values()))}"
    )
    return InputError(f"unknown {kind} {name!r}; {hint}")


def _listed(names: list[str]) -> str:
    """All names, or of a great many the first ones: a line is to be read."""
    more = len(names) - _MOST_LISTED
    return ", ".join([*names[:_MOST_LISTED], f"and {more} more"] if more > 1 else names)


_MOST_LISTED = 60
