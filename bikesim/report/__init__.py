"""Figures and tables."""

import logging

# Where the home folder cannot be written matplotlib takes a temporary one, and says so at length.
_OF_NO_USE = (
    "mkdir -p failed for path",
    "%s is not a writable directory",
    "Matplotlib created a temporary",
)
logging.getLogger("matplotlib").addFilter(lambda said: not str(said.msg).startswith(_OF_NO_USE))
