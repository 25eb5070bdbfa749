"""What a record says about its run: before it (header) and after it (ending)."""

from dataclasses import dataclass

from bikesim.errors import InputError
from bikesim.model.bicycle import Bicycle
from bikesim.record.provenance import Provenance


@dataclass(frozen=True)
class RunHeader:
    """What is known before the first tick.

    `scenario` is the resolved scenario as TOML text, `handlebar_inertia` I_δ [kg m²] of the rig,
    `seed` from 0 to 2**63 - 1, or None where nothing is random.
    """

    scenario: str
    bicycle: Bicycle
    law: str
    handlebar_inertia: float
    rig: str
    rider: str
    seed: int | None
    provenance: Provenance

    def __post_init__(self) -> None:
        if self.seed is not None and not 0 <= self.seed < 2**63:
            raise InputError(f"seed = {self.seed}: from 0 to 2**63 - 1")


@dataclass(frozen=True)
class Ending:
    """Why a run ended, in a few words, and when the bicycle fell [s], if it did."""

    reason: str
    fell: bool = False
    fall_time: float | None = None
