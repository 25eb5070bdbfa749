import math
import tomllib
from typing import Any

import numpy as np
import pytest

from bikesim import bicycles
from bikesim.errors import InputError
from bikesim.experiment.run import build, inertia_error, run
from bikesim.experiment.scenario import Scenario
from bikesim.model.eigen import bicycle_modes, simulator_modes
from bikesim.model.law import Law

NOISY = {"angle_noise": 1e-4, "rate_noise": 1e-3}


def _scenario(**keys: Any) -> Scenario:
    return Scenario(**keys)


class TestBuild:
    def test_the_rig_has_the_inertia_that_the_law_asks_for(self):
        """[SR13, Table 1] λ2, and M_δδ - M_φδ² / M_φφ."""
        for law, inertia in (("paper", 0.23108501173), ("momentum", 0.2312758932)):
            parts = build(_scenario(law=law))
            assert parts.rig.info.inertia == pytest.approx(inertia, abs=1e-10)

    def test_the_rig_keeps_an_inertia_of_its_own(self):
        parts = build(_scenario(rig={"inertia": 0.3}))
        assert parts.rig.info.inertia == 0.3

    def test_gravity_of_the_scenario(self):
        assert build(Scenario(gravity=9.7)).bicycle.gravity == 9.7

    def test_the_start_in_radians(self):
        parts = build(_scenario(start={"roll_deg": 3, "heading_deg": 90}))
        assert parts.start == pytest.approx((math.radians(3), 0, math.pi / 2))

    def test_a_physics_step_that_does_not_divide_the_period(self):
        with pytest.raises(InputError, match=r"physics_step = 0\.0003 s"):
            build(Scenario(physics_step=0.0003))


class TestInertiaError:
    def test_none_where_the_law_has_what_it_asks_for(self):
        assert inertia_error(build(Scenario())) is None

    def test_none_where_haptics_are_off(self):
        scenario = _scenario(law="off", rig={"inertia": 0.3})
        assert inertia_error(build(scenario)) is None

    def test_the_mode_that_is_farthest_off(self):
        error = inertia_error(build(_scenario(rig={"inertia": 0.3})))
        assert error is not None
        bicycle = bicycles.load("benchmark")
        is_ = simulator_modes(bicycle, Law.PAPER, 3.5, 0.3)
        should = bicycle_modes(bicycle, 3.5)
        assert (error.inertia, error.speed, error.mode) == (0.3, 3.5, "castering")
        assert error.eigenvalue_error == abs(is_.castering - should.castering)


class TestRun:
    def test_one_row_a_tick_a_period_apart(self, ridden):
        assert np.array_equal(ridden(period=0.005).time, np.arange(60) * 0.005)

    def test_the_header_says_what_was_ridden(self, ridden):
        record = ridden(bicycle="davis", law="momentum", rider="pd", rig="delft2013", seed=9)
        assert (record.bicycle.name, record.law) == ("davis", "momentum")
        assert (record.rider, record.rig, record.seed) == ("pd", "delft2013", 9)
        assert Scenario(**tomllib.loads(record.scenario)).seed == 9

    def test_the_ending_of_a_whole_run(self, ridden):
        ending = ridden().ending
        assert (ending.reason, ending.fell, ending.fall_time) == ("end of run", False, None)

    def test_the_start_is_the_first_row(self, ridden):
        record = ridden(start={"roll_deg": 5, "roll_rate_deg_s": -2, "heading_deg": 30})
        first = [record.channel(name)[0] for name in ("roll", "roll_rate", "heading")]
        assert first == pytest.approx(np.radians([5, -2, 30]))

    def test_a_fall_ends_it(self, ridden):
        record = ridden(rider="hands-off", start={"roll_deg": 30}, duration=5)
        assert record.ending.fell
        assert record.ending.reason == "fell to the right: roll beyond 45 deg"
        assert record.ending.fall_time == record.time[-1]
        assert abs(record.channel("roll")[-1]) > math.pi / 4 >= abs(record.channel("roll")[-2])

    def test_speed_follows_its_profile(self, ridden):
        record = ridden(speed_profile=[[0.1, 3], [0.2, 4]])
        assert record.channel("speed") == pytest.approx(np.clip(10 * record.time + 2, 3, 4))

    def test_hands_off_in_the_plane_nothing_moves(self, ridden):
        record = ridden(rider="hands-off")
        for name in ("roll", "steer", "sent_torque", "y"):
            assert np.all(record.channel(name) == 0)
        assert record.channel("x") == pytest.approx(3.5 * record.time)

    def test_left_and_right_are_alike(self, ridden):
        left, right = (
            ridden(f"{side}.h5", rider="pd", start={"roll_deg": side}, law="momentum")
            for side in (-2, 2)
        )
        for name in ("roll", "steer", "sent_torque", "y"):
            assert np.array_equal(left.channel(name), -right.channel(name))

    def test_the_same_seed_the_same_noise(self, ridden):
        first, second = (ridden(name, rig=NOISY) for name in ("a.h5", "b.h5"))
        assert first.digest() == second.digest()

    def test_another_seed_other_noise_of_rider_and_sensors(self, ridden):
        first, second = (ridden(f"{seed}.h5", rig=NOISY, seed=seed) for seed in (1, 2))
        for name in ("rider_torque", "steer"):
            assert not np.array_equal(first.channel(name), second.channel(name))

    def test_the_seed_of_the_sensors_is_not_that_of_the_rider(self, ridden):
        """A rig with noise leaves the rider's own remnant as it was."""
        plain = ridden("a.h5", rider={"roll_gain": 0, "roll_rate_gain": 0})
        noisy = ridden("b.h5", rider={"roll_gain": 0, "roll_rate_gain": 0}, rig=NOISY)
        assert np.array_equal(plain.channel("rider_torque"), noisy.channel("rider_torque"))

    def test_an_interruption_ends_it_after_the_tick(self, tmp_path):
        asked = iter([False, False, True])
        ending = run(build(Scenario()), tmp_path / "run.h5", interrupted=lambda: next(asked))
        assert ending.reason == "interrupted"


class TestTheRig:
    def test_is_closed_when_its_record_cannot_be_opened(self, tmp_path, monkeypatch):
        parts = build(Scenario(duration=0.1))
        closed = []
        monkeypatch.setattr(parts.rig, "close", lambda: closed.append(True))
        with pytest.raises(InputError, match="is a folder"):
            run(parts, tmp_path)
        assert closed
