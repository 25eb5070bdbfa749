import numpy as np
import pytest
from matplotlib.figure import Figure

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
