"""The software that a run's figures depend on."""

from importlib.metadata import version
from typing import NamedTuple, Self

import bikesim


class Versions(NamedTuple):
    """Of what computes a run."""

    bikesim: str
    mujoco: str
    numpy: str

    @classmethod
    def gather(cls) -> Self:
        """Those installed."""
        return cls(bikesim.__version__, version("mujoco"), version("numpy"))

    def __str__(self) -> str:
        return ", ".join(f"{name} {value}" for name, value in self._asdict().items())
