"""Margins over speed, as rows for people and programs."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.margins import ALLOWED_EXCESS, Margin, margin_at
from bikesim.model.sampled_loop import RELEASED, Grip, SampledLoop
from bikesim.model.simulator import handlebar_inertia

HEADER = (
    "v [m/s]", "margin", "delay left [ms]", "limit [Hz]", "less stable by [1/s]", "at grip J b k",
    "mode [Hz]", "off the bicycle [1/s]", "by inertia",
)  # fmt: skip


@dataclass(frozen=True)
class MarginsTable:
    """The margins of a loop at several speeds."""

    name: str
    bicycle: Bicycle
    law: Law
    loop: SampledLoop
    rows: tuple[Margin, ...]

    @property
    def wanted_inertia(self) -> float:
        """What the law asks for [kg m²]."""
        return handlebar_inertia(self.bicycle, self.law)

    def as_text(self) -> list[list[str]]:
        """The cells under `HEADER`."""
        return [_cells(row) for row in self.rows]

    def about(self) -> list[str]:
        """The loop in lines for a person."""
        loop, ms = self.loop, 1e3
        lines = [
            f"{self.name}: {self.bicycle.name}, "
            + ("haptics off" if self.law is Law.OFF else f"law {self.law}"),
            f"loop     period {ms * loop.period:g} ms, delay {ms * loop.delay:g} ms"
            + (f", motor lag {ms * loop.motor_lag:g} ms" if loop.motor_lag else "")
            + (f", a sample every {ms * loop.sensor_interval:g} ms" if self._is_slow else "")
            + (
                f", filter {loop.filter_cutoff:g} rad/s order {loop.filter_order}"
                if loop.filter_cutoff
                else ""
            ),
            f"bar      {loop.inertia:.4g} kg m² of {self.wanted_inertia:.4g} that the law asks for"
            + (f", friction {loop.viscous_friction:g} N m s/rad" if loop.viscous_friction else ""),
        ]
        if loop.coupling:
            inertia, stiffness, damping = loop.coupling
            lines.append(
                f"coupling {inertia:.4g} kg m² simulated, on {stiffness:.4g} N m/rad and "
                f"{damping:.4g} N m s/rad"
            )
        return lines

    @property
    def _is_slow(self) -> bool:
        return self.loop.ticks_per_sample > 1

    def as_json(self) -> dict[str, Any]:
        """Keys with their units."""
        loop = self.loop
        return {
            "name": self.name,
            "bicycle": self.bicycle.name,
            "law": self.law.value,
            "inertia_kg_m2": loop.inertia,
            "wanted_inertia_kg_m2": self.wanted_inertia,
            "period_s": loop.period,
            "delay_s": loop.delay,
            "motor_lag_s": loop.motor_lag,
            "sensor_interval_s": loop.sensor_interval,
            "filter_cutoff_rad_s": loop.filter_cutoff,
            "filter_order": loop.filter_order if loop.filter_cutoff else None,
            "viscous_friction_N_m_s_rad": loop.viscous_friction,
            "coupling": None if loop.coupling is None else _coupling_json(loop),
            "allowed_excess_1_s": ALLOWED_EXCESS,
            "speeds": [_row_json(row) for row in self.rows],
        }


def margins_table(
    name: str, bicycle: Bicycle, law: Law, loop: SampledLoop, speeds: Sequence[float]
) -> MarginsTable:
    """The margins at forward speeds [m/s]."""
    rows = tuple(margin_at(bicycle, law, speed, loop) for speed in speeds)
    return MarginsTable(name, bicycle, law, loop, rows)


def _cells(row: Margin) -> list[str]:
    never = math.isinf(row.delay_margin)
    return [
        f"{row.speed:g}",
        "yes" if row.is_there else "NO",
        "any" if never else f"{1e3 * row.delay_margin:.1f}",
        "" if never else f"{row.delay_frequency / (2 * math.pi):.1f}",
        f"{row.excess:.2f}",
        _grip(row.grip),
        f"{row.mode.imag / (2 * math.pi):.1f}",
        f"{row.error:.2f}",
        f"{row.inertia_error:.2f}",
    ]


def _grip(grip: Grip) -> str:
    return "released" if grip == RELEASED else " ".join(f"{figure:g}" for figure in grip)


def _coupling_json(loop: SampledLoop) -> dict[str, float]:
    assert loop.coupling is not None
    inertia, stiffness, damping = loop.coupling
    return {
        "inertia_kg_m2": inertia,
        "stiffness_N_m_rad": stiffness,
        "damping_N_m_s_rad": damping,
    }


def _row_json(row: Margin) -> dict[str, Any]:
    return {
        "speed_m_s": row.speed,
        "margin": row.is_there,
        "delay_margin_s": row.delay_margin,
        "delay_frequency_rad_s": row.delay_frequency,
        "excess_1_s": row.excess,
        "grip": {
            "inertia_kg_m2": row.grip.inertia,
            "damping_N_m_s_rad": row.grip.damping,
            "stiffness_N_m_rad": row.grip.stiffness,
        },
        "mode_1_s": [row.mode.real, row.mode.imag],
        "error_1_s": row.error,
        "inertia_error_1_s": row.inertia_error,
    }
