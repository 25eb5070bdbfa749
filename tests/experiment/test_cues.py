"""Tasks and cues as they are ridden."""

import tomllib

import numpy as np
import pytest

from bikesim.path.building import make_path
from bikesim.path.settings import PathSettings

LEAN = {"start": {"roll_deg": 3}}


class TestHaptics:
    def test_delayed_it_is_the_torque_of_before(self, ridden):
        run = ridden(haptics={"delay": 0.02}, **LEAN)
        wanted, sent = run.channel("feedback_torque"), run.channel("sent_torque")
        assert not sent[:20].any()
        # The guard slews the first torque after the delay.
        assert np.array_equal(sent[40:], wanted[20:-20])

    def test_switched_off_they_are_off_and_until_then_nothing_is_changed(self, ridden):
        usual = ridden("usual.h5", **LEAN)
        switched = ridden("switched.h5", haptics={"switches": [[0.15, 0.0]]}, **LEAN)
        for name in ("roll", "steer", "sent_torque", "rider_torque"):
            assert np.array_equal(usual.channel(name)[:150], switched.channel(name)[:150])
        assert not switched.channel("sent_torque")[152:].any()
        assert switched.channel("feedback_torque")[152:].all()

    def test_limited(self, ridden):
        sent = ridden(haptics={"limit": 0.1}, **LEAN).channel("sent_torque")
        assert np.abs(sent).max() == 0.1


class TestStart:
    def test_steered(self, ridden):
        run = ridden(start={"steer_deg": -4}, rider="hands-off")
        assert run.channel("steer")[0] == pytest.approx(np.radians(-4))
        assert run.channel("steer_rate")[0] == 0


class TestPath:
    def test_points_of_a_path_stay_with_the_record(self, ridden, tmp_path):
        """As many as there may be."""
        x = np.linspace(0, 5000, 5000)
        lines = [f"{a!r},{b!r}" for a, b in zip(x.tolist(), np.sin(x / 30).tolist(), strict=True)]
        (tmp_path / "track.csv").write_text("\n".join(lines))
        run = ridden(path=str(tmp_path / "track.csv"), duration=0.02)
        (tmp_path / "track.csv").unlink()

        path = make_path(PathSettings(**tomllib.loads(run.scenario)["path"]))
        assert path.length == pytest.approx(np.hypot(np.diff(x), np.diff(np.sin(x / 30))).sum())


class TestDisturbances:
    def test_are_recorded_as_they_were(self, ridden):
        run = ridden(disturbances=[{"kind": "roll-multisine", "torque_rms": 2, "start": 0.1}])
        roll = run.channel("roll_moment")
        assert not roll[:100].any()
        assert roll[100:].all()
        assert np.abs(np.diff(roll[100:])).max() < 2 * 20 * 1e-3 * np.sqrt(24)

    def test_leave_the_noise_of_rider_and_sensors_as_it_was(self, ridden):
        blind = {"rider": {"roll_gain": 0, "roll_rate_gain": 0}, "rig": {"rate_noise": 1e-3}}
        plain = ridden("plain.h5", **blind)
        windy = ridden("windy.h5", disturbances=[{"kind": "wind"}], **blind)
        assert windy.channel("roll_moment").any()
        assert np.array_equal(plain.channel("rider_torque"), windy.channel("rider_torque"))
