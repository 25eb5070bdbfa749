"""Eigenvalues over speed of a bicycle and of its simulator under each law."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from bikesim.model.bicycle import Bicycle
from bikesim.model.eigen import (
    Modes,
    StabilityLimits,
    bicycle_modes,
    simulator_modes,
    stability_limits,
)
from bikesim.model.law import Law
from bikesim.model.simulator import handlebar_inertia


@dataclass(frozen=True)
class EigenvalueRow:
    """The modes at one speed [m/s]; eigenvalues in 1/s."""

    speed: float
    bicycle: Modes
    paper: Modes
    momentum: Modes


@dataclass(frozen=True)
class EigenvalueTable:
    """Rows by speed, the inertia each law asks for [kg m²], the bicycle's own limits [m/s].

    `inertia` is that of the rig where it was given, else None: each law then has its own.
    """

    bicycle: Bicycle
    inertia_paper: float
    inertia_momentum: float
    inertia: float | None
    limits: StabilityLimits
    rows: tuple[EigenvalueRow, ...]

    def as_json(self) -> dict[str, Any]:
        """The keys of `bikesim eig --json`."""
        return {
            "bicycle": self.bicycle.name,
            "handlebar_inertia_kg_m2": {
                "paper": self.inertia_paper,
                "momentum": self.inertia_momentum,
            },
            "weave_speed_m_s": self.limits.weave,
            "capsize_speed_m_s": self.limits.capsize,
            "rows": [
                {
                    "speed_m_s": row.speed,
                    "bicycle": _pairs(row.bicycle),
                    "paper": _pairs(row.paper),
                    "momentum": _pairs(row.momentum),
                }
                for row in self.rows
            ],
        }

    def as_text(self) -> list[list[str]]:
        """Three lines a speed: speed, whose, castering, capsize, weave."""
        return [
            [f"{row.speed:g}" if whose == "bicycle" else "", whose, *_words(getattr(row, whose))]
            for row in self.rows
            for whose in ("bicycle", "paper", "momentum")
        ]


def eigenvalue_table(
    bicycle: Bicycle, speeds: Sequence[float], inertia: float | None = None
) -> EigenvalueTable:
    """The table at these speeds [m/s]; `inertia` [kg m²] of the rig, by default as asked."""
    return EigenvalueTable(
        bicycle=bicycle,
        inertia_paper=handlebar_inertia(bicycle, Law.PAPER),
        inertia_momentum=handlebar_inertia(bicycle, Law.MOMENTUM),
        inertia=inertia,
        limits=stability_limits(bicycle),
        rows=tuple(
            EigenvalueRow(
                speed,
                bicycle_modes(bicycle, speed),
                simulator_modes(bicycle, Law.PAPER, speed, inertia),
                simulator_modes(bicycle, Law.MOMENTUM, speed, inertia),
            )
            for speed in speeds
        ),
    )


def _pairs(modes: Modes) -> list[list[float]]:
    return [[s.real, s.imag] for s in modes.all()]


def _words(modes: Modes) -> list[str]:
    first, second = modes.weave
    if first.imag == 0:
        weave = f"{first.real:.4f}, {second.real:.4f}"
    else:
        weave = f"{first.real:.4f} ± {first.imag:.4f}i"
    return [_number(modes.castering), _number(modes.capsize), weave]


def _number(s: complex) -> str:
    return f"{s.real:.4f}" if s.imag == 0 else f"{s.real:.4f} {s.imag:+.4f}i"
