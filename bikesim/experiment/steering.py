"""What the hands did: work, and how often they turned the other way."""

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]


def work(torque: Reals, rate: Reals, period: float) -> tuple[float, float]:
    """∫ T δ̇ dt [J], and of its positive part alone; trapezium rule over samples (m,)."""
    power = torque * rate
    return _integral(power, period), _integral(np.maximum(power, 0.0), period)


def _integral(values: Reals, period: float) -> float:
    if len(values) < 2:
        return 0.0
    return float(period * (values.sum() - 0.5 * (values[0] + values[-1])))


def reversals(angle: Reals, gap: float) -> int:
    """How often the angle (m,) turned back by `gap` [rad] or more from where it had come to."""
    change = np.sign(np.diff(angle))
    turning = np.flatnonzero(change[1:] != change[:-1]) + 1
    count, way = 0, 0
    low = high = float(angle[0]) if len(angle) else 0.0
    for value in [*angle[turning].tolist(), *angle[-1:].tolist()]:
        low, high = min(low, value), max(high, value)
        if way >= 0 and high - value >= gap:
            count += way > 0
            way, low, high = -1, value, value
        elif way <= 0 and value - low >= gap:
            count += way < 0
            way, low, high = 1, value, value
    return count
