"""bikesim bench calibrate"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from bikesim.cli.bench.identify import ask
from bikesim.cli.bench.options import BenchName, arg
from bikesim.cli.output import print_table
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError

if TYPE_CHECKING:
    from bikesim.bench.calibrate_bench import NodeCalibrator
    from bikesim.bench.calibration import NodeCalibration
    from bikesim.bench.profile import BenchSettings


@dataclass(frozen=True)
class Calibrate:
    """Zero, angle scale and gyro scale of this bench's steer sensors, from a few held positions.

    You turn the bar to each position, by a protractor on it, then swing it. With the emergency stop
    pressed; the calibration goes into the sensor node, and into the profile, which must be a .toml
    file of yours, so that no ride begins with another. Of a bench whose steer is the drive's
    encoder the zero goes into the profile.
    """

    bench: BenchName
    positions: Annotated[
        str, arg("DEG,DEG,...", "To hold the bar at, right positive (default: -30,0,30).")
    ] = "-30,0,30"
    anew: Flag = False
    """These are other sensors than those the node was calibrated for: any scale, either sign."""
    restore: Annotated[
        Path | None, arg("FILE", "Measure nothing: store one that was kept (.node.DATE.bak).")
    ] = None
    yes: Flag = False
    """Store without asking."""

    def __call__(self) -> int:
        from bikesim.bench.profile import load_bench
        from bikesim.bench.profile_file import own_profile

        positions = parse_positions(self.positions)
        bench = load_bench(self.bench)
        path = own_profile(self.bench)
        if bench.bar.source == "drive":
            if self.restore is not None:
                raise InputError(
                    f'--restore {self.restore}: bar.source = "drive", there is no sensor node'
                )
            return self._encoder(bench, path, positions)
        return self._node(bench, path, positions)

    def _node(self, bench: "BenchSettings", path: Path, positions: list[float]) -> int:
        from bikesim.bench.bus import close_bus
        from bikesim.bench.calibrate_bench import NodeCalibrator, on_node_bus
        from bikesim.bench.calibration_kept import keep_calibration, kept_calibration

        again = None if self.restore is None else kept_calibration(self.restore)
        bus, link = on_node_bus(bench)
        try:
            calibrator = NodeCalibrator(link, _asked)
            old = calibrator.acting
            if again is None:
                new = self._measured(calibrator, positions)
            else:
                calibrator.check_unpowered()
                new = again
                _tell(old, new, "kept")
            if not self._agreed("store it in the sensor node"):
                return 0
            kept = keep_calibration(path, old)
            # First: a ride that is refused costs a pulse, one too many has a wrong sign.
            _change(path, bench, {"bar.calibration": list(new.counts())})
            calibrator.store(new)
        finally:
            close_bus(bus)
        print(f"stored in the node and written to {path}; as the node was: {kept}")
        _tell_next(self.bench)
        return 0

    def _measured(self, calibrator: "NodeCalibrator", positions: list[float]) -> "NodeCalibration":
        found = calibrator.measure(positions, anew=self.anew)
        _tell(calibrator.acting, found.calibration, "found")
        print(
            f"positions within {math.degrees(found.off_line):.2f} deg of a line; the gyro's "
            f"integral within {100 * found.swing_misfit:.1f} % of the angle"
        )
        return found.calibration

    def _encoder(self, bench: "BenchSettings", path: Path, positions: list[float]) -> int:
        from bikesim.bench.calibrate import encoder_zero
        from bikesim.bench.calibrate_bench import encoder_angle

        held = []
        for angle in positions:
            _asked(f"turn the bar to {math.degrees(angle):+g} deg and hold it;")
            held.append((angle, encoder_angle(bench)))
        zero = round(encoder_zero(held), 5)
        print(f"drive_zero  {zero:g} rad (profile: {bench.bar.drive_zero:g})")
        if not self._agreed(f"write it into {path}"):
            return 0
        kept = _change(path, bench, {"bar.drive_zero": zero})
        print(f"written to {path}; as it was: {kept}")
        _tell_next(self.bench)
        return 0

    def _agreed(self, what: str) -> bool:
        if self.yes or ask(f"{what}? [y/N]").lower() in ("y", "yes"):
            return True
        print("nothing was changed")
        return False


def _change(path: Path, bench: "BenchSettings", entries: dict[str, float | list[int]]) -> Path:
    """In the profile; other sensors or signs: what the pulse proved is proven no more."""
    from bikesim.bench.profile_file import change_profile

    cleared = {"commissioned": ""} if bench.commissioned else {}
    return change_profile(path, {**entries, **cleared})


def _tell_next(name: str) -> None:
    print(f"the pulse has to be passed again: bikesim bench check {name} --pulse, hands off")


def parse_positions(text: str) -> list[float]:
    """ "-30,0,30" in radians. Raises InputError."""
    try:
        degrees = [float(part) for part in text.split(",")]
    except ValueError:
        degrees = []
    if len(set(degrees)) < 2 or not all(abs(one) < 90 for one in degrees):
        raise InputError(
            f"--positions {text}: must be two or more angles between -90 and 90 deg (-30,0,30)"
        )
    return [math.radians(one) for one in degrees]


def _asked(question: str) -> str:
    return ask(f"{question} then Enter")


def _tell(old: "NodeCalibration", new: "NodeCalibration", whence: str) -> None:
    rows = [
        [name, f"{getattr(old, key):.5g}", f"{getattr(new, key):.5g}", unit]
        for name, key, unit in (
            ("potentiometer, straight ahead", "pot_zero", "of its range"),
            ("angle scale", "angle_scale", "rad over the range"),
            ("gyro, at rest", "gyro_zero", "of its range"),
            ("rate scale", "rate_scale", "rad/s over the range"),
        )
    ]
    print_table(["", "in the node", whence, ""], rows, left=1)
