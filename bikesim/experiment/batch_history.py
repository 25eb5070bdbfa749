"""Keeps the signals of a batch at the rate that metrics are computed from."""

import numpy as np
from numpy.typing import NDArray

from bikesim.experiment.history import SIGNALS, History, stride
from bikesim.model.real import Real
from bikesim.record.channels import TICK_CHANNELS
from bikesim.record.header import Ending
from bikesim.rig.virtual import VIRTUAL_CHANNELS

_NAMES = [channel.name for channel in (*TICK_CHANNELS, *VIRTUAL_CHANNELS)]
_COLUMNS = [_NAMES.index(name) for name in SIGNALS]


class BatchHistory:
    """Takes the rows of `ride`, arrays (n,) in them, and gives each rig's `History`."""

    def __init__(self, rigs: int, period: float, ticks: int) -> None:
        self._period, self._planned = period, ticks
        self._every = stride(period)
        samples = -(-ticks // self._every)
        # A rig's samples side by side, for the metrics; the time is one for all.
        self._kept = np.zeros((len(SIGNALS), rigs, samples))
        self._tick = 0

    def append(self, row: tuple[Real, ...]) -> None:
        """A tick's row."""
        sample, left = divmod(self._tick, self._every)
        if left == 0:
            for kept, column in zip(self._kept, _COLUMNS, strict=True):
                kept[:, sample] = row[column]
        self._tick += 1

    def history(self, rig: int, ending: Ending, ticks: int) -> History:
        """Of one rig, which rode so many ticks."""
        samples = -(-ticks // self._every)
        signals = dict(zip(SIGNALS, self._signals(rig, samples), strict=True))
        return History(
            period=self._every * self._period,
            every=self._every,
            ticks=ticks,
            ending=ending,
            planned_duration=self._planned * self._period,
            **signals,
        )

    def _signals(self, rig: int, samples: int) -> NDArray[np.float64]:
        return self._kept[:, rig, :samples]
