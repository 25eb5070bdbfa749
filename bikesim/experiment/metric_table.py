"""Each metric of a run with its unit, its definition and where that comes from."""

from typing import NamedTuple


class Metric(NamedTuple):
    """One metric: `name` is a column of the results table, `unit` "1" where there is none.

    `shown` is the unit in which a page shows it, and `factor` what that takes. `better` says which
    way is better: "less", "more", or "" where that depends on what is asked.
    """

    name: str
    unit: str
    definition: str
    source: str
    better: str = ""
    shown: str = ""
    factor: float = 1.0

    @property
    def shown_unit(self) -> str:
        """The unit on a page; empty where there is none."""
        unit = self.shown or self.unit
        return "" if unit == "1" else unit


_DEGREES = 57.29577951308232
_OURS = "ours"
_LIST = "SI; over all samples until the fall"


def _angle(name: str, what: str) -> Metric:
    return Metric(f"{name}_rms", "rad", f"RMS of {what}.", _LIST, "less", "deg", _DEGREES)


def _rate(name: str, what: str) -> Metric:
    return Metric(f"{name}_rms", "rad/s", f"RMS of {what}.", _LIST, "less", "deg/s", _DEGREES)


METRICS = (
    Metric("fell", "1", "1 if the bicycle fell or the bar hit its stop, else 0.", "guard", "less"),
    Metric(
        "fall_time", "s", "Time of the fall; NaN for a run that stayed up.", "guard", "more",
    ),
    Metric("duration", "s", "Time ridden: until the end, the fall or a fault.", "loop", "more"),
    _angle("roll", "the roll angle φ"),
    _rate("roll_rate", "the roll rate φ̇"),
    _angle("steer", "the steer angle δ of the bar itself, not as sensed"),
    _rate("steer_rate", "the steer rate δ̇ of the bar itself, not as sensed"),
    Metric("feedback_torque_rms", "N m", "RMS of the feedback torque as sent.", _LIST),
    Metric("rider_torque_rms", "N m", "RMS of T_δ, arms not counted.", _LIST, "less"),
    Metric(
        "lateral_rms", "m", "RMS of the distance e of the rear contact from the path.",
        "Green 2013, SAE J2944", "less",
    ),
    Metric("lateral_mean", "m", "Mean of e; > 0: to the right of the path.", "SAE J2944"),
    Metric(
        "sdlp", "m", "Standard deviation of lateral position: that of e about its mean.",
        "O'Hanlon 1984; SAE J2944", "less",
    ),
    Metric("lateral_max", "m", "Largest \\|e\\|.", "SAE J2944", "less"),
    Metric(
        "work_net", "J", "∫ T_δ δ̇ dt, trapezium: what the rider's torque gave to the bar, less "
        "what it took.", "mechanics",
    ),
    Metric(
        "work_positive", "J", "∫ max(T_δ δ̇, 0) dt: what the rider's torque gave to the bar.",
        "mechanics", "less",
    ),
    Metric(
        "steer_reversals", "1/s", "Changes of steer direction by 2° or more, a second ridden; not "
        "filtered.", "gap definition of SAE J2944; gap ours",
    ),
    Metric(
        "saturated", "1", "Share of samples with the feedback torque sent at the smallest limit of "
        "guard, rig and haptics.", _OURS, "less",
    ),
    Metric(
        "torque_power_low", "N² m²", "Power of T_δ below 0.5 Hz.", "Welch 1967; bands ours",
    ),
    Metric(
        "torque_power_middle", "N² m²", "Power of T_δ from 0.5 to 2 Hz.", "Welch 1967; bands ours",
    ),
    Metric(
        "torque_power_high", "N² m²", "Power of T_δ from 2 Hz up.", "Welch 1967; bands ours",
    ),
    Metric(
        "torque_median_frequency", "Hz", "Half of the power of T_δ lies below it.", "Welch 1967",
    ),
    Metric(
        "torque_centroid_frequency", "Hz", "Mean of the frequencies, weighed with the power of "
        "T_δ.", "Welch 1967",
    ),
    Metric(
        "crossover_frequency", "rad/s", "Where the rider's open loop has gain 1, from a run with a "
        "multisine.", "McRuer & Jex 1967; instrument: van der El et al. 2018", "more",
    ),
    Metric(
        "phase_margin", "rad", "π + the phase of that loop there.", "McRuer & Jex 1967", "more",
        "deg", _DEGREES,
    ),
    Metric(
        "handling_quality", "1", "Largest HQM over frequency, of Hess's rider from his gains; NaN "
        "of other riders.", "Hess, Moore & Hubbard 2012", "less",
    ),
)  # fmt: skip

# What a fall is about. Any other metric of a run that fell is mostly that of its fall, so of a
# condition it is told of the runs that came to their end.
FALL_TIME = "fall_time"
"""Its median is that of all runs by Kaplan-Meier: of the fallen alone it would be too early."""
OF_ALL_RUNS = ("fell", FALL_TIME, "duration")
WHOLE = "end of run"
"""How a run ends that nothing ended before its time."""

BY_NAME = {metric.name: metric for metric in METRICS}
