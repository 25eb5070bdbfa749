"""The whole answer: which method, which torque, which warnings."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.experiment.disturbances import Disturbance
from bikesim.experiment.run import build, run
from bikesim.experiment.scenario import Scenario
from bikesim.identify.answer import Question
from bikesim.identify.estimate import Method
from bikesim.identify.ride import Ride, read_ride
from bikesim.identify.rider import identify_rider

from .conftest import GAINS, OMEGA, multisine, simulate


def test_the_answer_of_a_noisy_ride(noisy: list[Ride]):
    found = identify_rider(noisy[:1], Question())
    assert (found.method, found.torque, found.lines) == (Method.INSTRUMENTAL_VARIABLE, "rider", 12)
    assert [gain.name for gain in found.gains] == ["k_phi", "k_phi_dot", "k_int", "k_delta_dot"]
    for gain, true in zip(found.gains, GAINS.tolist(), strict=True):
        assert gain.low < gain.value < gain.high
        assert abs(gain.value - true) < 3.5 * gain.standard_error
        assert (gain.high - gain.low) / gain.standard_error == pytest.approx(2 * 1.95996, rel=1e-4)
    assert found.warnings == ()
    assert found.noise_rms == pytest.approx(0.3, rel=0.1)
    (fit,) = found.fits
    left = fit.measured - fit.modelled
    assert found.vaf == pytest.approx(100 * (1 - np.var(left) / np.var(fit.measured)))
    assert found.vaf < found.least_squares_vaf  # which is all that least squares is best at
    assert np.diag(found.correlation) == pytest.approx(np.ones(4))
    wide = identify_rider(noisy[:1], Question(confidence=0.99)).gains[0]
    assert wide.high - wide.value == pytest.approx(2.5758 * wide.standard_error, rel=1e-4)


def test_a_rider_with_a_delay_and_arms_in_the_virtual_rig(tmp_path: Path):
    """The default rider: k_phi 0.43, k_phi_dot 1.74, delay 0.2 s, 30 rad/s, arms 0.1, 2, 5."""
    disturbance = Disturbance(kind="roll-multisine", torque_rms=2.0)
    run(build(Scenario(duration=60, disturbances=(disturbance,))), tmp_path / "run.h5")
    ride = read_ride(tmp_path / "run.h5")
    found = identify_rider([ride], Question("roll-pd"))
    assert found.free == ("delay",)
    for gain, true in zip(found.gains, (0.43, 1.74, 0.2), strict=True):
        assert abs(gain.value - true) < 3 * gain.standard_error
    assert found.gains[2].standard_error < 0.02
    found = identify_rider([ride], Question("roll-pd", delay=0.2, arms=True))
    assert found.torque == "bar"
    for gain, true in zip(found.gains, (0.43, 1.74, 0.1, 2.0, 5.0), strict=True):
        assert abs(gain.value - true) < 3.5 * gain.standard_error


def test_a_person_on_another_rig_without_a_known_disturbance(shared: Path):
    ride = read_ride(
        shared / "recordings" / "phobos_5mps.csv.gz",
        bicycle=bicycles.load("benchmark"),
        inertia=0.0427,
        gravity=9.80665,
    )
    found = identify_rider([ride], Question())
    assert (found.method, found.torque) == (Method.PREDICTION_ERROR, "bar")
    assert (found.lines, found.describing) == (None, None)
    assert np.isfinite([gain[2:] for gain in found.gains]).all()
    assert "no known disturbance is in the record" in found.warnings[0]
    assert any("fell at 31.89 s" in warning for warning in found.warnings)
    with pytest.raises(InputError, match="arms cannot be told from the bicycle itself"):
        identify_rider([ride], Question(arms=True))
    with pytest.raises(InputError, match="the instrumental variable needs one; --method"):
        identify_rider([ride], Question(method=Method.INSTRUMENTAL_VARIABLE))
    with pytest.raises(InputError, match="has no channel rider_torque; --torque bar"):
        identify_rider([ride], Question(torque="rider"))
    with pytest.raises(InputError, match="has no heading; structure hess2012 needs it"):
        identify_rider([ride], Question("hess2012"))


@pytest.mark.parametrize("harmonics", [(20,), (20, 45)])
def test_it_warns_of_too_few_frequencies(harmonics: tuple[int, ...]):
    (ride,) = simulate(multisine(30, harmonics=harmonics), [0.3])
    found = identify_rider([ride], Question())
    assert f"excites {len(harmonics)} frequenc" in found.warnings[0]
    assert "fewer than the 4 unknowns" in found.warnings[0]
    if len(harmonics) == 1:
        assert any("cannot tell all gains apart" in warning for warning in found.warnings)


def test_it_warns_where_arms_and_steer_feedback_cannot_be_told_apart(noisy: list[Ride]):
    found = identify_rider(noisy[:1], Question(arms=True, muscle_frequency=100.0))
    told = " ".join(found.warnings)
    assert "cannot tell all gains apart" in told
    assert "trade against each other" in told
    assert found.condition > 30


def test_it_warns_of_a_weak_disturbance():
    (ride,) = simulate(multisine(30, rms=0.05), [0.3])
    told = " ".join(identify_rider([ride], Question()).warnings)
    assert "moves the signals too little beside the noise" in told


def test_it_warns_of_what_befell_the_ride(noisy: list[Ride]):
    ride = replace(noisy[0], fell=61.0, speed_range=0.5)
    told = identify_rider([ride], Question()).warnings
    assert told == (
        "ride: fell at 61.00 s; only the 60.00 s before are used",
        "ride: the speed changes by 0.5 m/s; the gains are of its mean",
    )


def test_it_warns_of_methods_that_are_biased(exact: Ride):
    for method, words in (
        (Method.LEAST_SQUARES, "least squares is biased"),
        (Method.PREDICTION_ERROR, "prediction error is biased where"),
    ):
        found = identify_rider([exact], Question(method=method))
        assert words in found.warnings[0]


def test_a_structure_that_is_not_the_riders(exact: Ride):
    found = identify_rider([exact], Question("roll-pd", delay=0.0))
    assert found.vaf < 50
    assert any("explains only" in warning for warning in found.warnings)


def test_lags_held_and_free(exact: Ride):
    found = identify_rider([exact], Question(muscle_frequency="free", delay=0.0))
    assert found.free == ("muscle_frequency",)
    assert found.gains[-1].value == pytest.approx(OMEGA, rel=0.03)
    held = identify_rider([exact], Question(muscle_frequency=20.0, muscle_damping_ratio=1.0))
    assert held.lags[1:] == (20.0, 1.0)
    assert held.vaf < found.vaf


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"delay": -0.1}, "delay = -0.1: free, or from 0 to 1"),
        ({"muscle_frequency": 1e3}, "muscle_frequency = 1000.0: free, or from 2 to 200"),
        ({"muscle_damping_ratio": 0.0}, "muscle_damping_ratio = 0.0: from 0.05 to 10"),
        ({"confidence": 1.0}, "confidence = 1.0: from 0.5 to below 1"),
    ],
    ids=str,
)
def test_questions_that_cannot_be_asked(asked: dict, message: str):
    with pytest.raises(InputError, match=message):
        Question(**asked)


def test_questions_that_this_ride_does_not_answer(exact: Ride):
    with pytest.raises(InputError, match="without the arms; leave --torque out"):
        identify_rider([exact], Question(arms=True, torque="rider"))
    turning = replace(exact, straight=False)
    with pytest.raises(InputError, match="its path is not straight; structure hess2012"):
        identify_rider([turning], Question("hess2012"))
