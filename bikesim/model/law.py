"""The haptic laws by name."""

from enum import StrEnum


class Law(StrEnum):
    """How the feedback torque follows from the measured steer.

    `PAPER` is eq. 4 and 6 of [SR13]: M_φδ δ̈ dropped from the roll equation. `MOMENTUM` keeps it
    without measuring δ̈, by integrating M_φφ φ̇ + M_φδ δ̇. `OFF` is haptics off: T_f = 0.
    """

    PAPER = "paper"
    MOMENTUM = "momentum"
    OFF = "off"
