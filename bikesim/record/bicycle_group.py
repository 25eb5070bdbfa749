"""A bicycle in a run file: the matrices as datasets, the rest as attributes."""

from typing import Any

import h5py
import numpy as np

from bikesim.model.bicycle import Bicycle
from bikesim.model.parameters import PARAMETER_NAMES, BicycleParameters
from bikesim.model.whipple import Matrices

_UNITS = {"M": "kg m²", "C1": "kg m", "K0": "kg m", "K2": "kg"}
_GEOMETRY = {
    "wheelbase": "wheelbase_m",
    "trail": "trail_m",
    "steer_axis_tilt": "steer_axis_tilt_rad",
    "gravity": "gravity_m_s2",
}


def write_bicycle(group: h5py.Group, bicycle: Bicycle) -> None:
    """Every figure of a bicycle, so that `read_bicycle` gives the same bits back."""
    for name, unit in _UNITS.items():
        dataset = group.create_dataset(name, data=getattr(bicycle.matrices, name))
        dataset.attrs["unit"] = unit
    group.attrs["name"] = bicycle.name
    group.attrs["source"] = bicycle.source
    for name, attribute in _GEOMETRY.items():
        group.attrs[attribute] = getattr(bicycle, name)
    if bicycle.parameters is not None:
        parameters = group.create_group("parameters")
        for name in PARAMETER_NAMES:
            parameters.attrs[name] = getattr(bicycle.parameters, name)


def read_bicycle(group: h5py.Group) -> Bicycle:
    """The bicycle of a run. Raises KeyError for what is not there, InputError as `Bicycle` does."""
    attributes: Any = group.attrs
    return Bicycle(
        name=str(attributes["name"]),
        source=str(attributes["source"]),
        matrices=Matrices(**{name: np.asarray(group[name]) for name in _UNITS}),
        parameters=_read_parameters(group),
        **{name: float(attributes[attribute]) for name, attribute in _GEOMETRY.items()},
    )


def _read_parameters(group: h5py.Group) -> BicycleParameters | None:
    if "parameters" not in group:
        return None
    attributes: Any = group["parameters"].attrs
    return BicycleParameters(**{name: float(attributes[name]) for name in PARAMETER_NAMES})
