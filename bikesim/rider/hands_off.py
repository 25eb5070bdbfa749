"""Nobody at the bar."""

import numpy as np

from bikesim.model.real import Real
from bikesim.rider.base import Setting, Sight


class HandsOff:
    """No torque: the bicycle by itself."""

    def __init__(self, setting: Setting) -> None:
        del setting

    def intend(self, steer: Real, steer_rate: Real, seen: Sight) -> Real:
        """Zero."""
        return 0.0 if isinstance(steer, float) else np.zeros(np.shape(steer))
