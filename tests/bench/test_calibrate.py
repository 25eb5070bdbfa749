"""A person, in a script, who turns and swings an emulated bar."""

import math

import numpy as np
import pytest

from bikesim.bench.calibrate import Held, Swings, calibrated, encoder_zero
from bikesim.bench.calibrate_bench import NodeCalibrator
from bikesim.bench.calibration import NodeCalibration
from bikesim.bench.emulated.link import SimulatedLink
from bikesim.bench.emulated.steer_node import USUAL_CALIBRATION
from bikesim.bench.link import until
from bikesim.bench.sensor_node import SteerDecoder, SteerReading
from bikesim.errors import InputError

from .handled import POSITIONS, SENSORS, HandledBar, Person


def bench(
    sensors: NodeCalibration = SENSORS,
    stored: NodeCalibration | None = USUAL_CALIBRATION,
    off: dict[str, float] | None = None,
    noise: float = 0.0,
) -> tuple[HandledBar, Person, NodeCalibrator]:
    node = HandledBar(sensors, stored, noise)
    person = Person(node, off=off)
    return node, person, NodeCalibrator(SimulatedLink([node]), person, hold=0.2, swing=4.0)


def measured(
    node: HandledBar, calibrator: NodeCalibrator, steer: float, rate: float
) -> tuple[float, float]:
    """What the node says on average of a bar that is held there, or turns through there."""
    node.swinging, node.steer, node.steer_rate = False, steer, rate
    link, decoder, said = calibrator._link, SteerDecoder(), []
    for frame in until(link, link.now() + 0.5):
        reading = decoder.decode(frame.data, link.now()) if frame.id == decoder.id else None
        if isinstance(reading, SteerReading):
            said.append((reading.steer, reading.steer_rate))
    assert len(said) > 400
    return tuple(np.mean(said[20:], axis=0).tolist())


@pytest.mark.parametrize("noise", [0.0, 2e-4, 7e-4])
@pytest.mark.parametrize(
    "sensors",
    [
        SENSORS,
        NodeCalibration(0.62, 8.1, 0.44, 17.0, 3.3),
        NodeCalibration(0.35, -4.1, 0.55, 7.0, 3.3),
        NodeCalibration(0.5, 6.0, 0.5, -12.0, 3.3),
    ],
    ids=["a little off", "coarser", "pot mirrored", "gyro mirrored"],
)
def test_afterwards_the_node_measures_the_bar(sensors: NodeCalibration, noise: float):
    """Against the bar's own angle and rate; 7e-4 of a potentiometer's range is 4 mrad."""
    node, _, calibrator = bench(sensors, noise=noise)
    before = measured(node, calibrator, 0.3, 0.0)[0]
    assert abs(before - 0.3) > 0.01
    mirrored = min(sensors.angle_scale, sensors.rate_scale) < 0
    calibrator.store(calibrator.measure(POSITIONS, anew=mirrored).calibration)
    for steer in (-0.6, -0.2, 0.0, 0.35, 0.6):
        angle, rate = measured(node, calibrator, steer, 3 * steer)
        assert angle == pytest.approx(steer, abs=1e-3 + noise)
        assert rate == pytest.approx(3 * steer, rel=5e-3, abs=2e-3 + 5 * noise)


def test_a_person_who_is_half_a_degree_beside_each_position():
    """As far as he may be; the angle is then as wrong as he was, and no more."""
    node, _, calibrator = bench(off={"-30": 0.5, "+0": -0.4, "+30": 0.5})
    calibrator.store(calibrator.measure(POSITIONS).calibration)
    for steer in (-0.5, 0.0, 0.5):
        assert measured(node, calibrator, steer, 0.0)[0] == pytest.approx(
            steer, abs=math.radians(0.6)
        )


@pytest.mark.parametrize("stored", [USUAL_CALIBRATION, None], ids=["calibrated", "new"])
def test_the_sensors_become_what_they_are(stored: NodeCalibration | None):
    node, person, calibrator = bench(stored=stored)
    found = calibrator.measure(POSITIONS)
    calibrator.store(found.calibration)
    assert node.stored is not None
    assert node.stored.pot_zero == pytest.approx(SENSORS.pot_zero, abs=1e-4)
    assert node.stored.angle_scale == pytest.approx(SENSORS.angle_scale, rel=1e-3)
    assert node.stored.gyro_zero == pytest.approx(SENSORS.gyro_zero, abs=1e-4)
    assert node.stored.rate_scale == pytest.approx(SENSORS.rate_scale, rel=2e-3)
    assert node.stored.reference_voltage == USUAL_CALIBRATION.reference_voltage
    assert len(person.asked) == 4
    assert found.swing_misfit < 0.01
    assert found.off_line < 1e-3


def test_where_he_could_not_hold_it_he_says_where_it_is():
    _, person, calibrator = bench(off={"+30": -3.5})
    person.says["+30"] = "26.5"
    found = calibrator.measure(POSITIONS).calibration
    assert found.angle_scale == pytest.approx(SENSORS.angle_scale, rel=1e-3)


def test_nothing_is_measured_while_the_drive_may_have_power():
    node, person, calibrator = bench()
    node.estop_closed = True
    with pytest.raises(InputError, match="press the emergency stop first"):
        calibrator.measure(POSITIONS)
    assert person.asked == []


def test_a_position_read_wrongly_does_not_fit():
    node, _, calibrator = bench(off={"+0": 5.0})
    with pytest.raises(InputError, match=r"0 deg is \+3\.3 deg off the line"):
        calibrator.measure(POSITIONS)
    assert node.stored == USUAL_CALIBRATION


def test_a_bar_that_is_let_go_of_is_told():
    node, person, calibrator = bench()

    def restless(question: str) -> str:
        person(question)
        node.swinging = "-30" in question
        return ""

    calibrator = NodeCalibrator(SimulatedLink([node]), restless, hold=1.5, swing=4.0)
    with pytest.raises(InputError, match=r"moved by \d+\.\d deg while it was to be held at -30"):
        calibrator.measure(POSITIONS)


def test_mirrored_sensors_only_if_they_are_said_to_be_others():
    mirrored = SENSORS._replace(angle_scale=-5.2, rate_scale=-9.6)
    _, _, calibrator = bench(mirrored)
    with pytest.raises(InputError, match=r"angle scale would be -0\.90 of the one in the node"):
        calibrator.measure(POSITIONS)
    node, _, calibrator = bench(mirrored)
    calibrator.store(calibrator.measure(POSITIONS, anew=True).calibration)
    assert node.stored is not None
    assert node.stored.rate_scale == pytest.approx(-9.6, rel=2e-3)


def test_a_gyro_of_another_kind_is_no_calibration():
    _, _, calibrator = bench(SENSORS._replace(rate_scale=25.0))
    with pytest.raises(InputError, match=r"gyro scale would be 2\.39 of the one in the node"):
        calibrator.measure(POSITIONS)


def test_a_gyro_that_is_dead():
    node, _, calibrator = bench()
    node.gyro = 0.512
    with pytest.raises(InputError, match="the gyro's integral is"):
        calibrator.measure(POSITIONS)


def test_a_potentiometer_that_is_open():
    node, _, calibrator = bench()
    node.pot = 0.0
    with pytest.raises(InputError, match="is the potentiometer connected"):
        calibrator.measure(POSITIONS)


def test_an_answer_that_is_no_angle():
    _, person, calibrator = bench()
    person.says["-30"] = "left"
    with pytest.raises(InputError, match="left: must be an angle in degrees"):
        calibrator.measure(POSITIONS)


def test_swings_that_are_too_small():
    held = [Held(a, 0.5 + a / 5 + np.zeros(9), np.full(9, 0.5)) for a in POSITIONS]
    time = np.linspace(0, 4, 4000)
    swings = Swings(time, 0.5 + 0.01 * np.sin(time), 0.5 + 0.01 * np.cos(time))
    with pytest.raises(InputError, match="the swings are 5 deg wide: at least 20"):
        calibrated(held, swings, USUAL_CALIBRATION)


def test_positions_that_are_too_near():
    _, _, calibrator = bench()
    with pytest.raises(InputError, match="at least two, 20 deg apart"):
        calibrator.measure([0.0, 0.1])


def test_a_drives_encoder_gets_its_zero():
    held = [(angle, angle * 1.004 + 0.31) for angle in POSITIONS]
    assert encoder_zero(held) == pytest.approx(0.31)


def test_a_drives_encoder_behind_another_gear():
    with pytest.raises(InputError, match=r"turns 1\.100 times as far as the bar"):
        encoder_zero([(angle, 1.1 * angle) for angle in POSITIONS])
