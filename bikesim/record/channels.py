"""What is recorded at every tick: each channel with its unit and its sign."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Channel:
    """One recorded quantity: a float64 a tick.

    `name` is an identifier, `unit` "1" where there is none, `sign` what a positive value means.
    """

    name: str
    unit: str
    sign: str
    description: str

    def __post_init__(self) -> None:
        if not (self.name.isascii() and self.name.isidentifier()):
            raise ValueError(f"channel name {self.name!r}: must be an identifier in ASCII")


# Reproducible bit for bit: the same scenario and seed give the same values.
TICK_CHANNELS = (
    Channel("time", "s", "from the start of the run", "time at which the bar was read"),
    Channel("steer", "rad", "> 0 turns right", "steer angle as the sensors gave it"),
    Channel("steer_rate", "rad/s", "> 0 turning to the right", "steer rate as the sensors gave it"),
    Channel("speed", "m/s", "> 0 forward", "forward speed of the bicycle"),
    Channel("roll_moment", "N m", "> 0 leans right", "disturbance T_phi put into the bicycle"),
    Channel("steer_moment", "N m", "> 0 turns right", "disturbance T_delta put into the bicycle"),
    Channel("roll", "rad", "> 0 leans right", "roll angle of the bicycle"),
    Channel("roll_rate", "rad/s", "> 0 leaning to the right", "roll rate of the bicycle"),
    Channel(
        "roll_acceleration",
        "rad/s²",
        "as roll",
        "by the roll equation; law momentum: less its part of the steer acceleration",
    ),
    Channel("heading", "rad", "> 0 turned right", "heading (yaw) of the bicycle, eq. 8"),
    Channel("x", "m", "> 0 forward of the start", "rear contact point along the start heading"),
    Channel("y", "m", "> 0 right of the start", "rear contact point across the start heading"),
    Channel("distance", "m", "> 0 forward", "path length of the rear contact point"),
    Channel("feedback_torque", "N m", "> 0 turns right", "T_f of eq. 6 as the law gave it"),
    Channel("allowed_torque", "N m", "> 0 turns right", "feedback torque after the guard"),
    Channel("sent_torque", "N m", "> 0 turns right", "torque that the rig says it sent"),
    Channel(
        "limited",
        "1",
        "bit mask",
        "what the guard did: 1 clamped, 2 slewed, 4 refused; a bench: more, docs/bench.md",
    ),
)

# Measured on this machine in this run: never the same twice, so kept apart.
TIMING_CHANNELS = (
    Channel("wall_time", "s", "from the start of the run", "clock reading at which the tick began"),
    Channel("compute_time", "s", ">= 0", "from reading the sensors to showing the bicycle"),
)
