"""A sensor node's calibration in a file: kept before another one is stored, and read again."""

from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from bikesim.bench.calibration import NodeCalibration
from bikesim.bench.profile_file import kept_beside
from bikesim.errors import InputError
from bikesim.settings import Settings
from bikesim.textfile import located, read_toml

_Zero = Annotated[float, Field(ge=0, lt=1)]
_LEAST_SCALE = 0.1  # rad, rad/s: what the node takes


class _Kept(Settings):
    pot_zero: _Zero = Field(description="Of the potentiometer's range.")
    angle_scale: Annotated[float, Field(ge=-50, le=50)] = Field(description="[rad].")
    gyro_zero: _Zero = Field(description="Of the gyro's range.")
    rate_scale: Annotated[float, Field(ge=-2000, le=2000)] = Field(description="[rad/s].")
    reference_voltage: Annotated[float, Field(ge=0.5, le=5.5)] = Field(description="[V].")

    @model_validator(mode="after")
    def _has_scales(self) -> Self:
        for name in ("angle_scale", "rate_scale"):
            scale = getattr(self, name)
            if abs(scale) < _LEAST_SCALE:
                raise ValueError(
                    f"{name} = {scale}: must be {_LEAST_SCALE} or more, of either sign"
                )
        return self


def keep_calibration(profile: Path, calibration: NodeCalibration) -> Path:
    """Writes it into a file beside a profile, with the date in its name. Raises InputError."""
    kept = kept_beside(profile.with_suffix(".node"))
    lines = [f"{key} = {value!r}" for key, value in calibration._asdict().items()]
    text = "\n".join(("# In the sensor node before another calibration was stored.", *lines, ""))
    try:
        kept.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{kept}: {(error.strerror or str(error)).lower()}") from None
    return kept


def kept_calibration(path: Path) -> NodeCalibration:
    """Out of such a file. Raises InputError."""
    keys = read_toml(path, "node calibration")
    with located(f"node calibration {path}"):
        return NodeCalibration(**_Kept(**keys).model_dump())
