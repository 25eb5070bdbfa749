"""How our figures look, and how they are written."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bikesim.errors import InputError
from bikesim.record.output import put_in_place, unwritable

# Okabe & Ito's colours, told apart by colour-blind readers too.
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILION, PURPLE, GREY = "#0072B2", "#D55E00", "#CC79A7", "#777777"

_SETTINGS: Any = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.2,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "savefig.dpi": 160,
    "pdf.fonttype": 42,  # text stays text in a paper
    "svg.hashsalt": "bikesim",  # the same figure is the same file
}


@contextmanager
def styled() -> Iterator[None]:
    """Everything drawn inside has our look; nothing outside is changed."""
    with mpl.rc_context(_SETTINGS):
        yield


def figure(width: float, height: float) -> Figure:
    """An empty figure [inch] that no global state knows of."""
    return Figure(figsize=(width, height), layout="constrained")


def save(drawn: Figure, path: Path) -> Path:
    """Write a figure as its suffix says: .png, .pdf or .svg. Raises InputError."""
    suffix = path.suffix.lower()
    if suffix not in (".png", ".pdf", ".svg"):
        raise InputError(f"{path}: cannot draw to {path.suffix!r}; known: .png, .pdf, .svg")
    metadata = {"png": {"Software": None}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}
    kind = suffix[1:]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with styled(), put_in_place(path) as part:
            drawn.savefig(part, format=kind, metadata=metadata[kind])
    except OSError as error:
        raise unwritable(path, error) from error
    return path


def label(axes: Axes, *, x: str = "", y: str = "", title: str = "") -> None:
    """Labels with units, and a title."""
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    if title:
        axes.set_title(title)
