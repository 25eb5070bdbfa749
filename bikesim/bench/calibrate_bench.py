"""The guided part of a calibration: says what to do, and takes what the sensors say meanwhile."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from bikesim.bench.bus import close_bus, filter_for, open_bus
from bikesim.bench.calibrate import Calibrated, Held, Swings, calibrated
from bikesim.bench.calibration import CalibrationClient, NodeCalibration
from bikesim.bench.continuity import BadFrame
from bikesim.bench.database import STEER_REPLY, STEER_STATE, message
from bikesim.bench.drives import make_drive
from bikesim.bench.link import BusLink, Link, until
from bikesim.bench.parts import Parts, loop_port, on_the_bus
from bikesim.bench.profile import BenchSettings
from bikesim.bench.sensor_node import SteerDecoder, SteerReading
from bikesim.clock import RealTimeClock
from bikesim.errors import InputError

Ask = Callable[[str], str]

HOLD, SWING = 1.0, 10.0
"""So long each is looked at [s]."""

_SATURATED = 1.6383  # rad, the largest that SteerState can say
_RAW = (0.02, 0.98)


def on_node_bus(bench: BenchSettings):
    """The profile's bus, of which the sensor node alone is heard. The caller shuts it down."""
    bus = open_bus(bench.bus)
    try:
        filter_for(bus, (message(STEER_STATE).frame_id, message(STEER_REPLY).frame_id))
    except InputError:
        close_bus(bus)
        raise
    return bus, BusLink(bus)


class NodeCalibrator:
    """Over a link to a sensor node; the person is asked, and answers, by `ask`."""

    def __init__(self, link: Link, ask: Ask, *, hold: float = HOLD, swing: float = SWING) -> None:
        """`hold`, `swing` [s]: how long is looked."""
        self._link, self._ask, self._hold, self._swing = link, ask, hold, swing
        self._client = CalibrationClient(link)
        self._acting: NodeCalibration | None = None

    @property
    def acting(self) -> NodeCalibration:
        """What the node has now. Raises InputError if it does not answer."""
        if self._acting is None:
            self._acting = self._client.read()
        return self._acting

    def measure(self, positions: Sequence[float], *, anew: bool = False) -> Calibrated:
        """Through all `positions` [rad] and the swings; changes nothing. Raises InputError."""
        acting = self.acting
        self.check_unpowered()
        held = [self._held(angle) for angle in positions]
        self._ask(f"now swing the bar slowly to and fro, 20 deg and more, for {self._swing:g} s;")
        samples = self._samples(self._swing)
        pot, gyro = self._raw(samples)
        swings = Swings(np.array([one.time for one in samples]), pot, gyro)
        return calibrated(held, swings, acting, anew=anew)

    def check_unpowered(self) -> None:
        """Raises InputError while the emergency stop is closed: the drive may have power."""
        if self._samples(0.1)[-1].estop_closed:
            raise InputError(
                "press the emergency stop first: a calibration changes only without power"
            )

    def store(self, calibration: NodeCalibration) -> None:
        """In the node, which keeps it without power. Raises InputError."""
        self._client.change(calibration)
        self._acting = None

    def _held(self, angle: float) -> Held:
        degrees = math.degrees(angle)
        answer = self._ask(f"turn the bar to {degrees:+g} deg and hold it (or type where it is);")
        if answer:
            try:
                degrees = float(answer)
            except ValueError:
                raise InputError(f"{answer}: must be an angle in degrees, or nothing") from None
        if not abs(degrees) < 90:
            raise InputError(f"{degrees:g} deg: must be between -90 and 90")
        return Held(math.radians(degrees), *self._raw(self._samples(self._hold)))

    def _samples(self, duration: float) -> list[SteerReading]:
        """What comes from now on."""
        while self._link.receive(0.0) is not None:
            pass
        decoder, samples = SteerDecoder(), []
        for frame in until(self._link, self._link.now() + duration):
            if frame.id == decoder.id:
                reading = decoder.decode(frame.data, self._link.now())
                if not isinstance(reading, BadFrame):
                    samples.append(reading)
        if len(samples) < 0.5 * duration / 1e-3:
            raise InputError(
                f"{len(samples)} good sensor frames in {duration:g} s: is the node there? "
                "(bikesim bench check)"
            )
        return samples

    def _raw(self, samples: Sequence[SteerReading]) -> tuple[np.ndarray, np.ndarray]:
        """Potentiometer and gyro, 0 to 1, out of what the node makes of them."""
        acting = self.acting
        steer, rate = np.array([(one.steer, one.steer_rate) for one in samples]).T
        if np.abs(steer).max() >= _SATURATED:
            raise InputError(
                "the steer angle is beyond what the node's frames can say, ±94 deg: is the "
                "potentiometer connected?"
            )
        pot = acting.pot_zero + steer / acting.angle_scale
        gyro = acting.gyro_zero + rate / acting.rate_scale
        for name, raw in (("potentiometer", pot), ("gyro", gyro)):
            if raw.min() < _RAW[0] or raw.max() > _RAW[1]:
                raise InputError(
                    f"the {name} was at {100 * raw.min():.0f} to {100 * raw.max():.0f} % of its "
                    "range: allowed 2 to 98 %; its wiring, or swing slower"
                )
        return pot, gyro


def encoder_angle(bench: BenchSettings) -> float:
    """What the drive's encoder says of the bar now [rad]. Raises InputError.

    A person holds the bar: the drive is not enabled, its watchdog not tried either.
    """
    drive = make_drive(bench.drive)
    with on_the_bus(bench, drive, lambda line: None, prove=False) as bus:
        port = loop_port(bus, bench, drive)
        parts = Parts(bench, drive, port, RealTimeClock(bench.period))
        try:
            parts.rig.begin()
            said = []
            for _ in range(round(0.3 / bench.period)):
                parts.rig.read()
                seen = parts.rig.drive_view
                if seen.age < 0.05:
                    said.append(seen.steer)
                parts.rig.command(0.0)
                parts.rig.wait()
        finally:
            parts.rig.close()
    if len(said) < 10:
        raise InputError(f"{drive.name}: does not say where it is")
    return float(np.mean(said))
