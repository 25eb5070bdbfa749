import numpy as np
import pytest

from bikesim.experiment.history import SIGNALS, History, stride
from bikesim.record.reader import Run


@pytest.mark.parametrize(
    ("period", "every"),
    [(0.0001, 100), (0.001, 10), (0.002, 5), (0.003, 4), (0.005, 2), (0.01, 1), (0.02, 1)],
)
def test_the_stride_is_the_least_that_keeps_100_hz(period: float, every: int):
    assert stride(period) == every
    assert every * period >= 0.01 - 1e-12


def test_every_tenth_tick_of_a_record(ridden):
    record = ridden(duration=0.305, start={"roll_deg": 2})
    history = History.of_run(record)
    assert (history.period, history.every, history.ticks) == (pytest.approx(0.01), 10, 305)
    assert history.duration == pytest.approx(0.305)
    assert history.planned_duration == 0.305
    assert history.ending == record.ending
    for name in SIGNALS:
        assert np.array_equal(getattr(history, name), record.channel(name)[::10])


def test_a_slow_loop_keeps_all_its_ticks(ridden):
    record = ridden(period=0.02, duration=0.4)
    assert np.array_equal(History.of_run(record).roll, record.channel("roll"))


def test_a_fall_ends_it_before_its_time(ridden):
    history = History.of_run(ridden(rider="hands-off", start={"roll_deg": 30}, duration=5))
    assert history.ending.fell
    assert history.duration < history.planned_duration == 5


def test_a_rig_without_a_rider_model_has_no_rider_torque(ridden):
    record = ridden(rig={"angle_noise": 0.01})
    absent = ("rider_torque", "true_steer", "true_steer_rate")

    class Bench:
        """The record of a rig that has only the loop's own channels."""

        names = tuple(name for name in record.names if name not in absent)
        period, ticks, ending, scenario = (
            record.period, record.ticks, record.ending, record.scenario,
        )  # fmt: skip
        channel = staticmethod(record.channel)

    bench: Run = Bench()  # type: ignore[assignment]
    history = History.of_run(bench)
    assert np.isnan(history.rider_torque).all()
    for name in ("steer", "steer_rate"):
        sensed = record.channel(name)[::10]
        assert np.array_equal(getattr(history, name), sensed)
        assert np.array_equal(getattr(history, f"true_{name}"), sensed)
