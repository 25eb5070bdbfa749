"""What a run on a bench is, as a scenario: rig, limits and period are the bench's."""

import math

from bikesim.bench.profile import BenchSettings
from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario, to_toml
from bikesim.guard import GuardSettings
from bikesim.rig.settings import RigSettings

_MARK = "# bench: "


def bench_scenario(bench: BenchSettings, scenario: Scenario) -> Scenario:
    """The scenario with what the profile says; InputError for what only a virtual rig can do."""
    if scenario.start.steer_deg != 0:
        raise InputError("start.steer_deg: a bench's bar is where the hands hold it")
    bar, limits = bench.bar, bench.limits
    rig = RigSettings(
        description="the bar of a bench",
        inertia=bar.inertia,
        coulomb_friction=bar.coulomb_friction,
        viscous_friction=bar.viscous_friction,
        steer_stop_deg=bar.steer_stop_deg,
    )
    guard = GuardSettings(
        torque_limit=limits.torque,
        torque_rate_limit=limits.torque_rate,
        fall_roll_deg=bench.thresholds.fall_roll_deg,
    )
    speeds = [scenario.speed, *(speed for _, speed in scenario.speed_profile)]
    if max(speeds) > limits.speed:
        raise InputError(
            f"speed = {max(speeds):g} m/s: must be at most limits.speed = {limits.speed:g} m/s "
            "of the bench"
        )
    return scenario.model_copy(update={"rig": rig, "guard": guard, "period": bench.period})


def header_text(bench: BenchSettings, scenario: Scenario) -> str:
    """Scenario and profile in one text: a scenario file, with the profile as its comments."""
    import tomli_w

    profile = tomli_w.dumps(bench.model_dump(mode="json", exclude_none=True))
    return to_toml(scenario) + "".join(f"{_MARK}{line}\n" for line in profile.splitlines())


def profile_of(text: str) -> str:
    """The profile, TOML, out of a record's scenario text; empty if it is not of a bench."""
    lines = (line for line in text.splitlines() if line.startswith(_MARK.rstrip()))
    return "".join(f"{line[len(_MARK) :]}\n" for line in lines)


def sample_delay(bench: BenchSettings) -> int:
    """Whole periods from the bar's motion to the torque, as the sampled loop counts them."""
    return math.ceil(bench.bar.delay / bench.period - 1e-9)
