"""A bicycle written as the TOML that `toml_reader` reads."""

from dataclasses import asdict

from bikesim.bicycles.toml_reader import GEOMETRY_KEYS, MATRIX_KEYS
from bikesim.model.bicycle import Bicycle


def bicycle_to_toml(bicycle: Bicycle) -> str:
    """The text; every float with the digits that give the same float back."""
    import tomli_w

    head = {"name": bicycle.name, "source": bicycle.source, "gravity": float(bicycle.gravity)}
    return tomli_w.dumps(head | _figures(bicycle))


def _figures(bicycle: Bicycle) -> dict[str, dict[str, object]]:
    if bicycle.parameters is not None:
        return {"parameters": {key: float(x) for key, x in asdict(bicycle.parameters).items()}}
    return {
        "geometry": {key: float(getattr(bicycle, key)) for key in GEOMETRY_KEYS},
        "matrices": {key: getattr(bicycle.matrices, key).tolist() for key in MATRIX_KEYS},
    }
