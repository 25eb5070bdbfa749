import math

import numpy as np
import pytest

from bikesim.experiment.summary import summarise


def test_a_run_that_stays_up(ridden):
    summary = summarise(ridden())
    assert (summary.reason, summary.fell, summary.fall_time) == ("end of run", False, None)
    assert summary.ticks == 300
    assert summary.record.endswith("run.h5")


def test_a_run_that_falls(ridden):
    run = ridden(rider="hands-off", start={"roll_deg": 30}, duration=5)
    summary = summarise(run)
    assert summary.fell
    assert summary.fall_time == run.time[-1]
    assert summary.ticks == len(run.time) < 5000


def test_root_mean_square_of_a_roll_that_does_not_change(ridden):
    """At the start alone: one tick at 3 degrees."""
    summary = summarise(ridden(start={"roll_deg": 3}, duration=0.001))
    assert summary.rms_roll == pytest.approx(math.radians(3))


def test_the_torque_is_what_was_really_sent(ridden):
    run = ridden(start={"roll_deg": 5}, rig={"torque_limit": 0.01})
    assert summarise(run).rms_feedback_torque == pytest.approx(
        np.linalg.norm(run.channel("sent_torque")) / math.sqrt(300)
    )
    assert summarise(run).rms_feedback_torque <= 0.01


def test_simulated_over_wall_time(ridden):
    run = ridden()
    assert summarise(run).sim_over_wall == pytest.approx(0.3 / run.timing("wall_time")[-1])
