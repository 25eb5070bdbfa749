"""What happened in a run, for people and for programs."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bikesim.experiment.scenario import Scenario

if TYPE_CHECKING:
    from bikesim.experiment.run import InertiaError
    from bikesim.experiment.summary import Summary


def summary_json(summary: "Summary") -> dict[str, Any]:
    """The keys of `bikesim run --json`."""
    return {
        "record": summary.record,
        "fell": summary.fell,
        "fall_time_s": summary.fall_time,
        "reason": summary.reason,
        "ticks": summary.ticks,
        "rms_roll_rad": summary.rms_roll,
        "rms_steer_rad": summary.rms_steer,
        "rms_feedback_torque_N_m": summary.rms_feedback_torque,
        "sim_over_wall": summary.sim_over_wall,
    }


def summary_told(scenario: Scenario, summary: "Summary", picture: Path | None) -> str:
    """A run in a few lines."""
    law = "haptics off" if scenario.law == "off" else f"law {scenario.law}"
    speed = f"{scenario.speed:g} m/s" if not scenario.speed_profile else "a speed profile"
    ridden = summary.ticks * scenario.period
    path = "" if scenario.path.kind == "straight" else f", path {_path(scenario)}"
    lines = [
        f"{scenario.bicycle} at {speed}, {law}, "
        f"rider {scenario.rider.name}, rig {scenario.rig.name}{path}",
        *_cues(scenario),
        f"{_ending(summary)} ({ridden:.3f} s, {summary.ticks} ticks)",
        f"rms     roll {math.degrees(summary.rms_roll):.2f} deg, "
        f"steer {math.degrees(summary.rms_steer):.2f} deg, "
        f"feedback torque {summary.rms_feedback_torque:.3f} N m",
        f"speed   {summary.sim_over_wall:.1f} x real time",
        f"record  {summary.record}",
    ]
    return "\n".join(lines if picture is None else [*lines, f"figure  {picture}"])


def _path(scenario: Scenario) -> str:
    return scenario.path.file or scenario.path.kind


def _cues(scenario: Scenario) -> list[str]:
    """What of the cues is not as usual, in a line; none if nothing is."""
    usual = Scenario()
    changed = [
        f"{table}.{key} = {str(value).lower()}"
        for table in ("haptics", "vision")
        for key, value in getattr(scenario, table)
        if value != getattr(getattr(usual, table), key)
    ]
    return [f"cues    {', '.join(changed)}"] if changed else []


def _ending(summary: "Summary") -> str:
    if summary.fell and summary.fall_time is not None:
        return f"{summary.reason}, at {summary.fall_time:.2f} s"
    return "stayed up" if summary.reason == "end of run" else summary.reason


def inertia_told(wrong: "InertiaError") -> str:
    """The warning for a rig whose inertia is not what the law asks for."""
    return (
        f"note: the rig's handlebar inertia is {wrong.inertia:.4g} kg m², the law asks for "
        f"{wrong.wanted:.4g}: hands off at {wrong.speed:g} m/s the {wrong.mode} eigenvalue is "
        f"{wrong.eigenvalue_error:.2g} 1/s off the bicycle's"
    )
