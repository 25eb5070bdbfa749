"""The torque that a drive measures before it is told any: more than noise is fault 25."""

from bikesim.bench.faults import Thresholds
from bikesim.errors import InputError

_ALLOWED: float = Thresholds.model_fields["rest_torque"].default  # N m at the steer axis


def check_rest_torque(torque: float, allowed: float = _ALLOWED) -> None:
    """For a torque [N m] at the steer axis, as a drive that is told none measures it.

    Raises InputError where it is more than `allowed` [N m], the threshold `rest_torque`; a set-up
    knows of its default only.
    """
    if not abs(torque) <= allowed:
        raise InputError(
            f"fault 25: the drive measures {torque:+.2f} N m before it is told any; "
            f"allowed {allowed:g} N m"
        )
