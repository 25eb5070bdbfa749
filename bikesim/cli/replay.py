"""bikesim replay"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from bikesim.cli.output import print_json
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError


@dataclass(frozen=True)
class Replay:
    """Hold our law against a recording: of a run of ours, or of a real rig (CSV).

    Every tick's roll and steer as recorded give a torque and the roll one tick later; the errors
    against what was recorded are printed. A record of ours is also ridden again through the loop,
    on a rig that plays back its steer.
    """

    recording: Annotated[
        Path,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="RECORDING", help_behavior_hint=""),
    ]
    """A record of ours, or a CSV whose header names time_s, roll_rad, steer_rad, roll_rate_rad_s,
    steer_rate_rad_s, torque_command_Nm and speed_m_s (others are ignored; .gz is read too)."""
    bicycle: Annotated[
        str | None,
        tyro.conf.arg(
            metavar="NAME|FILE",
            help="By name or file (default: a record's own; benchmark for a CSV).",
            help_behavior_hint="",
        ),
    ] = None
    gravity: Annotated[
        float | None,
        tyro.conf.arg(
            metavar="M/S²", help="[m/s²] (default: of the bicycle's source).", help_behavior_hint=""
        ),
    ] = None
    torque_limit: Annotated[
        float | None,
        tyro.conf.arg(
            metavar="N·M",
            help="At which the recorded torque was clipped [N m] (default: not at all).",
            help_behavior_hint="",
        ),
    ] = None
    law: Annotated[
        str | None,
        tyro.conf.arg(
            metavar="LAW",
            help="paper, momentum or off (default: a record's own; paper for a CSV).",
            help_behavior_hint="",
        ),
    ] = None
    json: Flag = False
    """Print JSON."""

    def __call__(self) -> int:
        from bikesim import bicycles
        from bikesim.record.recording import read_recording
        from bikesim.record.replay import compare

        if self.torque_limit is not None and not self.torque_limit > 0:
            raise InputError(f"--torque-limit {self.torque_limit}: must be above 0 N m")
        recording = read_recording(self.recording)
        bicycle = recording.bicycle if self.bicycle is None else bicycles.load(self.bicycle)
        if bicycle is None:
            bicycle = bicycles.load("benchmark")
        if self.gravity is not None:
            bicycle = bicycle.with_gravity(self.gravity)
        result = compare(recording, bicycle, law=self.law, torque_limit=self.torque_limit)
        figures = result.as_json()
        if recording.run is not None and self.bicycle is None and self.law is None:
            from bikesim.experiment.ride_again import ride_again

            again = ride_again(recording.run)
            figures["ridden_again_rows"] = again.ticks
            # The guard of a bench saw more than what is in a record.
            of_bench = recording.run.rig == "bench"
            figures["max_ridden_again_torque_error_N_m"] = max(
                again.feedback_torque, 0.0 if of_bench else again.allowed_torque
            )
        if self.json:
            print_json(figures)
            return 0
        print(f"{self.recording}: {bicycle.name}, law {result.law}, g {bicycle.gravity} m/s²")
        for key, value in figures.items():
            print(f"  {_label(key)}: {_number(value)}")
        return 0


def _label(key: str) -> str:
    for suffix, unit in (("_N_m", " [N m]"), ("_rad_s", " [rad/s]"), ("_rad", " [rad]")):
        if key.endswith(suffix):
            return key.removesuffix(suffix).replace("_", " ") + unit
    return key.replace("_", " ")


def _number(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) and math.isfinite(value) else str(value)
