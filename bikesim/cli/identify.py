"""bikesim identify"""

from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from bikesim.cli.output import check_apart, check_figure, print_json, print_table
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError, unknown

if TYPE_CHECKING:
    from bikesim.identify.answer import Identification, Question
    from bikesim.identify.ride import Ride


def _arg(metavar: str, text: str, *aliases: str) -> Any:
    return tyro.conf.arg(metavar=metavar, help=text, help_behavior_hint="", aliases=list(aliases))


@dataclass(frozen=True)
class Identify:
    """Identify a rider: the gains with which he rode, from one or several records of his.

    With intervals, the share of the torque that they explain, and a figure. The gains of the
    disturbance's instrument are not biased by the rider's own noise; those of least squares, shown
    beside them, are.
    """

    what: Annotated[str, tyro.conf.Positional, _arg("rider", "What to identify: rider.")]
    records: Annotated[
        tuple[Path, ...],
        tyro.conf.Positional,
        _arg("RUN.h5 [RUN.h5 ...]", "Run files of ours, or recordings of another rig (.csv)."),
    ]
    structure: Annotated[
        str, _arg("NAME", "schwab2013, roll-pd or hess2012 (default: schwab2013).")
    ] = "schwab2013"
    arms: Flag = False
    """Identify passive arms too: inertia, damping, stiffness."""
    delay: Annotated[
        str | None,
        _arg("S|free", "Visual delay [s], or free (default: 0; free for roll-pd)."),
    ] = None
    muscle: Annotated[
        str | None,
        _arg("RAD/S|free", "Neuromuscular frequency [rad/s], or free (default: as published)."),
    ] = None
    muscle_damping: Annotated[
        float | None, _arg("RATIO", "Neuromuscular damping ratio (default: as published).")
    ] = None
    method: Annotated[
        str | None,
        _arg(
            "NAME",
            "instrumental-variable, prediction-error or least-squares (default: the first; the "
            "second without a known disturbance).",
        ),
    ] = None
    torque: Annotated[
        str | None,
        _arg(
            "NAME",
            "rider: the channel rider_torque; bar: what turned the bar beside the motor (default: "
            "the first, where it is there).",
        ),
    ] = None
    confidence: Annotated[float, _arg("SHARE", "Of the intervals (default: 0.95).")] = 0.95
    bicycle: Annotated[
        str | None, _arg("NAME|FILE", "By name or file (default: a record's own).")
    ] = None
    inertia: Annotated[
        float | None, _arg("KG·M²", "Of the rig's handlebar [kg m²] (default: a record's own).")
    ] = None
    gravity: Annotated[float | None, _arg("M/S²", "[m/s²] (default: of the bicycle's source).")] = (
        None
    )
    law: Annotated[
        str | None,
        _arg("LAW", "paper, momentum or off (default: a record's own; paper for a CSV)."),
    ] = None
    figure: Annotated[
        Path | None,
        _arg("FILE", "Where to draw it, .png, .pdf or .svg (default: rider-RUN.png here)."),
    ] = None
    force: Flag = False
    """Replace a figure that is there already."""
    json: Flag = False
    """Print JSON."""

    def __call__(self) -> int:
        from bikesim.identify.rider import identify_rider

        if self.what != "rider":
            raise unknown("thing to identify", self.what, ["rider"])
        if not self.records:
            raise InputError("RUN.h5 is missing (bikesim identify --help)")
        if self.figure is not None:
            check_apart(self.figure, *self.records)
            check_figure(self.figure, force=self.force)
        question = self._question()
        found = identify_rider(self._rides(), question)
        if self.json:
            if self.figure is not None:
                self._draw(found, self.figure)
            print_json(found.as_json())
            return 0
        _tell(found)
        print(f"figure  {self._drawn(found)}")
        for warning in found.warnings:
            print(f"warning: {warning}")
        return 0

    def _question(self) -> "Question":
        from bikesim.identify.answer import Question
        from bikesim.identify.estimate import Method

        sources = {"rider": "rider", "bar": "bar", None: None}
        if self.torque not in sources:
            raise InputError(f"--torque {self.torque}: must be rider or bar")
        if self.method is not None and self.method not in list(Method):
            raise unknown("method", self.method, list(Method))
        return Question(
            structure=self.structure,
            arms=self.arms,
            delay=_figure_or_free("--delay", self.delay),
            muscle_frequency=_figure_or_free("--muscle", self.muscle),
            muscle_damping_ratio=self.muscle_damping,
            method=None if self.method is None else Method(self.method),
            torque=sources[self.torque],
            confidence=self.confidence,
        )

    def _rides(self) -> "list[Ride]":
        from bikesim import bicycles
        from bikesim.identify.ride import read_ride
        from bikesim.model.law import Law

        if self.law is not None and self.law not in list(Law):
            raise InputError(f"--law {self.law}: must be one of {', '.join(Law)}")
        if self.inertia is not None and not 0 < self.inertia < 1e3:
            raise InputError(f"--inertia {self.inertia}: must be above 0 and below 1000 kg m²")
        bicycle = None if self.bicycle is None else bicycles.load(self.bicycle)
        law = None if self.law is None else Law(self.law)
        return [
            read_ride(path, bicycle=bicycle, inertia=self.inertia, gravity=self.gravity, law=law)
            for path in self.records
        ]

    def _drawn(self, found: "Identification") -> str:
        """The figure that nobody named is made where it can be; the answer stands."""
        if self.figure is not None:
            return str(self._draw(found, self.figure))
        path = Path(f"rider-{self.records[0].name.partition('.')[0]}.png")
        try:
            check_figure(path, force=self.force)
            return str(self._draw(found, path))
        except InputError as error:
            return f"not drawn: {error}"

    def _draw(self, found: "Identification", path: Path) -> Path:
        from bikesim.report.identification_figure import identification_figure
        from bikesim.report.style import save

        return save(identification_figure(found), path)


def _figure_or_free(option: str, text: str | None) -> Any:
    if text is None or text == "free":
        return text
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{option} {text}: must be a number or free") from None


def _tell(found: "Identification") -> None:
    ride = found.rides[0]
    several = f" and {len(found.rides) - 1} more" if len(found.rides) > 1 else ""
    source = {"rider": "rider_torque as recorded", "bar": "torque on the bar, by eq. 5"}
    law = "haptics off" if ride.law == "off" else f"law {ride.law}"
    print(
        f"{ride.name}{several}: {ride.bicycle.name} at {ride.speed:.4g} m/s, {law}, "
        f"{found.duration:.1f} s, {source[found.torque]}"
    )
    print(f"{found.structure.name}, {found.structure.source}{_held(found)}\n")
    share = f"{100 * found.question.confidence:g} %"
    print_table(
        ["gain", "unit", found.method.value, f"{share} interval", "least squares"],
        [
            [
                gain.name,
                gain.unit,
                f"{gain.value:.4g}",
                f"{gain.low:.4g} to {gain.high:.4g}",
                f"{gain.least_squares:.4g}",
            ]
            for gain in found.gains
        ],
        left=2,
    )
    print(
        f"\nexplained (VAF) {found.vaf:.1f} % of the torque; the rest is {found.noise_rms:.3g} N m "
        f"RMS. Least squares {found.least_squares_vaf:.1f} %: it\nfits the noise too, which has "
        "come round the loop, so its gains are biased; they are for comparison."
    )
    if found.lines is not None:
        strength = f", first stage F {found.strength:.0f}" if isfinite(found.strength) else ""
        print(f"{found.lines} frequencies excited, condition {found.condition:.1f}{strength}")


def _held(found: "Identification") -> str:
    lags = found.lags
    held = {
        "delay": f"delay {lags.delay:g} s",
        "muscle_frequency": f"G_nm {lags.muscle_frequency:.4g} rad/s",
        "muscle_damping_ratio": f"ratio {lags.muscle_damping_ratio:.4g}",
    }
    return "; held: " + ", ".join(text for name, text in held.items() if name not in found.free)
