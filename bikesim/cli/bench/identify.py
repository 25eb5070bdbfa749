"""bikesim bench identify"""

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from bikesim.cli.bench.options import BenchName, arg
from bikesim.cli.output import print_json, print_table
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError

if TYPE_CHECKING:
    from bikesim.bench.identify import BarFigures
    from bikesim.bench.profile import BenchSettings
    from bikesim.model.bicycle import Bicycle
    from bikesim.model.law import Law

_SPEEDS = (3.5, 5.0, 7.0)


@dataclass(frozen=True)
class Identify:
    """Inertia, friction, delay and torque of this bench's bar, from a small torque; hands off.

    Sines of at most 0.5 N m and a weak spring that keeps the bar centred, the guard in force.
    Intervals, what the law asks for, and the eigenvalue error and margins that follow.
    """

    bench: BenchName
    torque: Annotated[float, arg("N·M", "Of the excitation, at most 0.5 (default: 0.5).")] = 0.5
    duration: Annotated[float, arg("S", "Of the excitation [s] (default: 20).")] = 20.0
    added_inertia: Annotated[
        float | None,
        arg(
            "KG·M²", "Then once more with so much put on the bar: tells real torque from commanded."
        ),
    ] = None
    bicycle: Annotated[str, arg("NAME|FILE", "By name or file (default: benchmark).")] = "benchmark"
    law: Annotated[str, arg("LAW", "paper, momentum or off (default: paper).")] = "paper"
    confidence: Annotated[float, arg("SHARE", "Of the intervals (default: 0.95).")] = 0.95
    write: Flag = False
    """Write the figures into the profile, a .toml file of yours; the old one is kept beside it."""
    json: Flag = False
    """Print JSON instead."""

    def __call__(self) -> int:
        from bikesim.bench.identify import identify_bar
        from bikesim.bench.identify_bench import excite_bench, proposed
        from bikesim.bench.identify_excitation import Excitation
        from bikesim.bench.profile import load_bench
        from bikesim.bench.profile_file import change_profile, own_profile
        from bikesim.cli.margins import law_of, load_bicycle

        self._check()
        path = own_profile(self.bench) if self.write else None
        bench = load_bench(self.bench)
        bicycle, law = load_bicycle(self.bicycle, None), law_of(self.law)
        excitation = Excitation(
            min(self.torque, bench.limits.torque), self.duration, bench.bar.inertia
        )
        added = [0.0] if self.added_inertia is None else [0.0, self.added_inertia]
        records = excite_bench(bench, excitation, added, ask=ask, say=_to_stderr)
        figures = identify_bar(records, confidence=self.confidence)
        entries = proposed(figures)
        if self.json:
            print_json(_as_json(figures, bench, bicycle, law, entries))
        else:
            _tell(figures, bench, bicycle, law, entries)
        if path is not None:
            kept = change_profile(path, entries)
            _to_stderr(f"written to {path}; as it was: {kept}")
            _to_stderr(f"the bar is another one now: bikesim bench check {path} --pulse")
        return 0

    def _check(self) -> None:
        if not 5.0 <= self.duration <= 300.0:
            raise InputError(f"--duration {self.duration}: must be from 5 to 300 s")
        if not 0.0 < self.torque <= 0.5:
            raise InputError(f"--torque {self.torque}: must be above 0 and at most 0.5 N m")
        if self.added_inertia is not None and not 1e-4 <= self.added_inertia <= 10.0:
            raise InputError(f"--added-inertia {self.added_inertia}: must be from 0.0001 to 10")
        if not 0.5 <= self.confidence < 1.0:
            raise InputError(f"--confidence {self.confidence}: must be from 0.5 to below 1")


def ask(question: str) -> str:
    """A line from the person at the bench. Raises InputError where there is none."""
    print(question, end=" ", file=sys.stderr, flush=True)
    line = sys.stdin.readline()
    if not line:
        raise InputError("nobody answers at the terminal: nothing more was done")
    return line.strip()


def _to_stderr(line: str) -> None:
    print(line, file=sys.stderr)


def _tell(
    figures: "BarFigures",
    bench: "BenchSettings",
    bicycle: "Bicycle",
    law: "Law",
    entries: dict[str, float],
) -> None:
    rows = [
        [
            one.name.replace("_", " "),
            f"{one.value:.4g}",
            f"{one.low:.4g} to {one.high:.4g}",
            one.unit,
            f"{_of_profile(bench, one.name)}",
        ]
        for one in figures.all()
    ]
    print_table(
        ["", "identified", f"{100 * figures.confidence:g} % interval", "", "profile"], rows, left=1
    )
    print(
        f"\nleft unexplained: {1e3 * figures.angle_error:.2g} mrad, "
        f"{1e3 * figures.rate_error:.2g} mrad/s rms"
    )
    for line in _compared(figures, bicycle, law):
        print(line)
    print("\nfor the profile:\n[bar]")
    for where, value in entries.items():
        print(f"{where.removeprefix('bar.')} = {value!r}")


def _of_profile(bench: "BenchSettings", name: str) -> str:
    value = getattr(bench.bar, name, None)
    return "" if value is None else f"{value:g}"


def _compared(figures: "BarFigures", bicycle: "Bicycle", law: "Law") -> list[str]:
    from bikesim.model.margins import inertia_error
    from bikesim.model.simulator import handlebar_inertia

    one, wanted = figures.inertia, handlebar_inertia(bicycle, law)
    errors = ", ".join(
        f"{inertia_error(bicycle, law, speed, one.value):.2g} at {speed:g} m/s" for speed in _SPEEDS
    )
    lines = [
        f"the law asks for {wanted:.4g} kg m²; the bar has {100 * one.value / wanted:.1f} % of it: "
        f"eigenvalues off the bicycle's [1/s]: {errors}"
    ]
    ratio = figures.torque_ratio
    if ratio is None:
        lines.append(
            "whether a commanded N m is a real one only weights can tell (--added-inertia); "
            "inertia and friction are in commanded N m, as the law needs them"
        )
    elif abs(ratio.value - 1) > max(0.05, ratio.half):
        lines.append(
            f"the motor gives {100 * ratio.value:.0f} % of what is commanded: correct its torque "
            "constant (in drive and profile), or the gear, and identify again"
        )
    return lines


def _as_json(
    figures: "BarFigures",
    bench: "BenchSettings",
    bicycle: "Bicycle",
    law: "Law",
    entries: dict[str, float],
) -> dict[str, Any]:
    from bikesim.model.margins import inertia_error
    from bikesim.model.simulator import handlebar_inertia

    return {
        "figures": [one._asdict() for one in figures.all()],
        "confidence": figures.confidence,
        "angle_error_rad": figures.angle_error,
        "rate_error_rad_s": figures.rate_error,
        "profile_inertia_kg_m2": bench.bar.inertia,
        "wanted_inertia_kg_m2": handlebar_inertia(bicycle, law),
        "eigenvalue_errors": [
            {"speed_m_s": v, "error_1_s": inertia_error(bicycle, law, v, figures.inertia.value)}
            for v in _SPEEDS
        ],
        "proposed": entries,
    }
