"""Everything that the frames of a video are made from."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bikesim.view.layout import Layout
from bikesim.view.quality import Quality
from bikesim.view.reel import Reel


@dataclass(frozen=True, eq=False)
class Film:
    """Runs, one a column of the layout; frame k shows them `elapsed[k]` [s] after their begin."""

    reels: tuple[Reel, ...]
    layout: Layout
    elapsed: NDArray[np.float64]
    quality: Quality
    overlay: bool = True
