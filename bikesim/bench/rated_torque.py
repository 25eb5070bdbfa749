"""The unit of a drive's rated torque (object 6076) against the motor's nameplate.

The standard has it in mN m; some makers' drives have µN m. A wrong unit is a torque wrong by a
thousand, so what the drive says, in the unit of the profile, must be what the nameplate says.
"""

from bikesim.errors import InputError

UNITS = {"uNm": 1e-6, "mNm": 1e-3}  # N m

_TOLERANCE = 0.02


def check_rated_torque(raw: int, unit: str, nameplate: float) -> float:
    """The rated torque [N m] that the drive has. Raises InputError where it contradicts."""
    if _agrees(raw * UNITS[unit], nameplate):
        return raw * UNITS[unit]
    said = f"the drive's rated torque (6076) is {raw} {unit} = {raw * UNITS[unit]:.4g} N m"
    for other, size in UNITS.items():
        if _agrees(raw * size, nameplate):
            raise InputError(
                f"{said}, the nameplate's {nameplate:g} N m: its unit is {other}, set torque_unit"
            )
    raise InputError(f"{said}, the nameplate's {nameplate:g} N m: set the drive or rated_torque")


def _agrees(torque: float, nameplate: float) -> bool:
    return abs(torque - nameplate) <= _TOLERANCE * nameplate
