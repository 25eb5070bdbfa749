import numpy as np
import pytest
from matplotlib.figure import Figure

from bikesim import bicycles
from bikesim.report.eigenvalue_figure import eigenvalue_figure
from bikesim.report.eigenvalue_table import eigenvalue_table
from bikesim.report.style import BLACK, BLUE, VERMILION


def drawn(speeds: list[float], bicycle: str = "benchmark", inertia: float | None = None) -> Figure:
    return eigenvalue_figure(eigenvalue_table(bicycles.load(bicycle), speeds, inertia))


def lines(figure: Figure, part: int, colour: str) -> list[np.ndarray]:
    """Speeds and values of the lines of one colour, without the line of zero."""
    found = [line for line in figure.axes[part].lines if line.get_color() == colour]
    data = [np.asarray(line.get_data()) for line in found]
    return [values for values in data if values.shape[1] > 2]


@pytest.mark.parametrize(
    ("whose", "colour"), [("bicycle", BLACK), ("paper", VERMILION), ("momentum", BLUE)]
)
def test_lines_are_the_real_parts_of_the_table(whose: str, colour: str):
    found = lines(drawn([0, 10]), 0, colour)
    speeds = found[0][0]
    table = eigenvalue_table(bicycles.load("benchmark"), speeds.tolist())
    expected = [[s.real for s in getattr(row, whose).all()] for row in table.rows]
    assert np.array_equal(np.array([values for _, values in found]).T, expected)


def test_imaginary_parts_are_the_frequencies_that_there_are():
    """[M07, Table 2]: 4.46487 rad/s at 5 m/s."""
    values = [
        value
        for speeds, column in lines(drawn([0, 10]), 1, BLACK)
        for value in column[np.isclose(speeds, 5)]
        if np.isfinite(value)
    ]
    assert values == [pytest.approx(4.46486771378823)]


def test_the_stable_range_is_shaded_between_weave_and_capsize():
    """[M07]: 4.292 to 6.024 m/s."""
    figure = drawn([0, 10])
    (span,) = figure.axes[0].patches
    x = span.get_extents().transformed(figure.axes[0].transData.inverted())
    assert (x.x0, x.x1) == pytest.approx((4.29238253634, 6.02426201539))


@pytest.mark.parametrize(("speeds", "last"), [([5], 10), ([0, 3], 10), ([0, 20], 20)])
def test_a_few_speeds_are_drawn_on_a_fine_grid(speeds, last: float):
    found, _ = lines(drawn(speeds), 0, BLACK)[0]
    assert (found[0], found[-1]) == (0, last)
    assert len(found) > 200


def test_axes_say_what_and_in_which_unit():
    real, imaginary = drawn([0, 10]).axes
    assert (real.get_xlabel(), real.get_ylabel()) == ("forward speed v [m/s]", "Re λ [1/s]")
    assert imaginary.get_ylabel() == "Im λ [rad/s]"
    assert real.get_title("left") == "benchmark"
    assert imaginary.get_legend_handles_labels()[1] == [
        "bicycle", "simulator, law paper", "simulator, law momentum",
    ]  # fmt: skip


def test_the_inertia_is_named():
    assert drawn([5]).axes[1].get_title("left") == "I = 0.2311 / 0.2313 kg m²"
    assert drawn([5], inertia=0.3).axes[1].get_title("left") == "I = 0.3 kg m²"


def test_a_bicycle_known_by_its_matrices_only():
    assert drawn([0, 10], "davis").axes[0].get_title("left") == "davis"
