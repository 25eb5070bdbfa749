from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from bikesim.errors import InputError
from bikesim.record.reader import Run
from bikesim.report.run_figure import run_figure
from bikesim.report.style import BLUE, ORANGE, VERMILION


def data(figure: Figure, axes: int, line: int = 0) -> np.ndarray:
    return np.asarray(figure.axes[axes].lines[line].get_data())


@pytest.mark.parametrize(("axes", "channel"), [(0, "roll"), (1, "steer")])
def test_angles_over_time_in_degrees(upright: Run, axes: int, channel: str):
    time, angle = data(run_figure([upright]), axes)
    assert np.array_equal(time, upright.time)
    assert np.array_equal(angle, np.degrees(upright.channel(channel)))


@pytest.mark.parametrize(
    ("line", "channel", "colour"), [(0, "sent_torque", BLUE), (1, "rider_torque", ORANGE)]
)
def test_torques_over_time(upright: Run, line: int, channel: str, colour: str):
    figure = run_figure([upright])
    assert np.array_equal(data(figure, 2, line)[1], upright.channel(channel))
    assert figure.axes[2].lines[line].get_color() == colour


def test_the_path_with_right_downwards(upright: Run):
    figure = run_figure([upright])
    x, y = data(figure, 3)
    assert np.array_equal(x, upright.channel("x"))
    assert np.array_equal(y, upright.channel("y"))
    assert figure.axes[3].yaxis_inverted()


def test_axes_say_what_and_in_which_unit(upright: Run):
    labels = [axes.get_ylabel() for axes in run_figure([upright]).axes]
    assert labels == ["roll φ [deg]", "steer δ [deg]", "torque [N m]", "to the right y [m]"]


def test_the_title_says_what_was_ridden(upright: Run):
    title = run_figure([upright]).axes[0].get_title("left")
    assert title == "benchmark, 3.5 m/s, law paper, rider human, rig ideal"


def test_a_fall_is_marked_and_told(fallen: Run):
    figure = run_figure([fallen])
    assert fallen.ending is not None
    marked = data(figure, 0, 1)
    assert marked[0] == pytest.approx([fallen.ending.fall_time])
    assert marked[1] == pytest.approx(np.degrees(fallen.channel("roll")[-1:]))
    assert f"fell at {fallen.ending.fall_time:.2f} s" in figure.axes[0].get_title("left")


def test_several_runs_each_in_a_colour(upright: Run, fallen: Run):
    figure = run_figure([upright, fallen])
    roll = figure.axes[0]
    assert [line.get_color() for line in roll.lines[:2]] == [BLUE, VERMILION]
    assert roll.get_legend_handles_labels()[1] == [
        "law paper, human", "haptics off, hands-off",
    ]  # fmt: skip


def test_a_long_run_is_thinned_for_the_page(ridden):
    run = ridden("long", duration=15)
    time, _ = data(run_figure([run]), 0)
    assert len(time) <= 8000
    assert time[-1] == pytest.approx(15, abs=0.01)


def test_a_changing_speed_is_told_by_its_range(ridden):
    run = ridden("profile", speed_profile=[[0, 3.5], [0.499, 4]])
    assert "3.5 to 4 m/s" in run_figure([run]).axes[0].get_title("left")


LANE = {"kind": "lane-change", "start": 0, "length": 8, "offset": 1.0}
STRAIGHT_ON = {"rider": "hands-off", "start": {"roll_deg": 0}, "duration": 5}


@pytest.fixture(scope="module")
def lane(ridden) -> Run:
    """A lane change at once, which a rider who knows of none does not ride."""
    return ridden("lane", path=LANE, **STRAIGHT_ON)


class TestPrescribedPath:
    def test_lies_under_the_ridden_one(self, lane: Run):
        figure = run_figure([lane])
        (x, y), (ridden_x, ridden_y) = data(figure, 4, 0), data(figure, 4, 1)
        u = np.clip(x / 8, 0, 1)
        assert y == pytest.approx(10 * u**3 - 15 * u**4 + 6 * u**5, abs=1e-4)
        assert x[-1] == pytest.approx(lane.channel("x")[-1], abs=0.3)
        assert np.array_equal(ridden_x, lane.channel("x"))
        assert np.array_equal(ridden_y, lane.channel("y"))

    def test_deviation_over_time(self, lane: Run):
        figure = run_figure([lane])
        assert figure.axes[3].get_ylabel() == "off the path [m]"
        time, deviation = data(figure, 3)
        assert deviation[0] == pytest.approx(0, abs=1e-9)
        assert deviation[time > 2.5] == pytest.approx(-1.0)  # straight on is left of the new lane

    def test_a_long_one_is_stretched_and_a_round_one_is_not(self, ridden, lane: Run):
        assert run_figure([lane]).axes[4].get_aspect() == "auto"
        circle = {"kind": "circle", "radius": 4.0, "start": 0.0, "entry": 1.0}
        round_about = ridden("round", path=circle, **{**STRAIGHT_ON, "duration": 9})
        assert run_figure([round_about]).axes[4].get_aspect() == 1
        assert np.ptp(data(run_figure([round_about]), 4, 0)[1]) == pytest.approx(8, abs=0.1)

    def test_two_runs_of_one_path_show_it_once(self, ridden, lane: Run):
        off = ridden("off", law="off", path=LANE, **STRAIGHT_ON)
        figure = run_figure([lane, off])
        assert len(figure.axes[4].lines) == 3

    def test_a_record_of_none_has_the_straight_line(self, upright: Run):
        before = replace(upright, scenario="speed = 3.5")
        assert len(run_figure([before]).axes) == 4

    def test_one_that_cannot_be_read_is_told_with_its_record(self, upright: Run):
        damaged = replace(upright, scenario='[path]\nkind = "zigzag"')
        with pytest.raises(InputError) as refused:
            run_figure([damaged])
        told = f"{upright.path}: its scenario: unknown path.kind 'zigzag'"
        assert str(refused.value).startswith(told)
