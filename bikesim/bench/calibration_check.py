"""Whether the sensor node has the calibration with which a profile's pulse was passed.

A node that was replaced, or calibrated with another profile, may measure mirrored: the feedback
would be positive, and the mark of the pulse still be there.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bikesim.bench.bus import filter_for
from bikesim.bench.calibration import CalibrationClient, NodeCalibration, Parameter
from bikesim.bench.database import STEER_REPLY, message
from bikesim.bench.finding import Finding
from bikesim.bench.link import BusLink, Link
from bikesim.errors import InputError
from bikesim.textfile import located

if TYPE_CHECKING:
    import can

NOT_CHECKED = (
    "its calibration is not checked: the profile has no bar.calibration (bench calibrate writes it)"
)

_UNITS = ("of its range", "rad", "of its range", "rad/s", "V")  # in the order of `Parameter`


def link_to_node(bus: "can.BusABC") -> Link:
    """On this bus, which is filtered for the node's answers. Raises InputError."""
    filter_for(bus, (message(STEER_REPLY).frame_id,))
    return BusLink(bus)


def check_calibration(link: Link, wanted: Sequence[int]) -> None:
    """Raises InputError if the node has another calibration than `wanted`, in its own counts, or
    does not say which one.
    """
    with located("fault 22: bar.calibration cannot be checked"):
        has = CalibrationClient(link).read()
    if said := differences(has, wanted):
        raise InputError(
            f"fault 22: the sensor node's calibration is not this profile's: {said}; was it "
            "replaced, or calibrated with another profile? bikesim bench calibrate (or, if it is "
            f"right, bar.calibration = {list(has.counts())}), then the pulse again"
        )


def calibration_finding(link: Link, wanted: Sequence[int] | None) -> Finding:
    """For `bench check`; `wanted` as above, None: any."""
    what, any_will_do = "sensor node: calibration", wanted is None
    should = "any: no bar.calibration in the profile" if any_will_do else "as in the profile"
    try:
        has = CalibrationClient(link).read()
    except InputError as error:
        return Finding(any_will_do, what, str(error), should)
    said = "" if wanted is None else differences(has, wanted)
    return Finding(not said, what, said or f"{list(has.counts())}", should)


def differences(has: NodeCalibration, wanted: Sequence[int]) -> str:
    """The figures of a node's calibration that are not the `wanted` ones; empty: none."""
    should = NodeCalibration.of_counts(tuple(wanted))
    return ", ".join(
        f"{parameter.name.lower().replace('_', ' ')} {_told(one)} {unit} (profile {_told(other)})"
        for parameter, unit, one, other in zip(Parameter, _UNITS, has, should, strict=True)
        if one != other
    )


def _told(figure: float) -> str:
    """To less than a count of any figure, the finest of which are 1e-6."""
    return f"{round(figure, 6):.10g}"
