from bikesim import bicycles
from bikesim.bench.onlooker import Phase, Sight
from bikesim.bench.showing import Showing
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law
from bikesim.view.drawing import INK
from bikesim.view.live.messages import Figures, message
from bikesim.view.live.words import Line, fitting, plate

BICYCLE = bicycles.load("benchmark")


def state(**keys: float) -> BicycleState:
    start = HapticBicycle(BICYCLE, Law.PAPER).start(speed=3.46)
    return start._replace(**keys)


def showing(haptics: str = "haptics on, law paper") -> Showing:
    return Showing(BICYCLE, None, True, None, 0.0, (), haptics, 1.0)


def texts(lines: tuple[Line, ...]) -> list[str]:
    return [line.text for line in lines]


def test_the_figures_of_a_ride():
    at = Figures(showing()).at(state(time=12.34, steer=-0.0436))
    assert texts(at.left) == ["3.5 m/s", "steer 2.5° left", "12.3 s"]
    assert texts(at.right) == ["haptics on, law paper"]


def test_no_figure_tells_of_the_roll():
    upright, leaning = (Figures(showing()).at(state(time=2.0, roll=r)) for r in (0.0, 0.4))
    assert upright == leaning


def test_while_the_torque_ramps_in_it_says_so():
    figures = Figures(showing())
    assert texts(figures.at(state(time=0.5)).right) == ["the torque ramps in"]
    assert texts(figures.at(state(time=1.1)).right) == ["haptics on, law paper"]


def test_the_figures_change_ten_times_a_second():
    figures = Figures(showing())
    seen = [figures.at(state(time=k / 100, speed=k / 10)) for k in range(100)]
    assert 9 <= len(set(seen)) <= 11
    # The next ride begins at no time again.
    assert texts(figures.at(state(time=0.0, speed=7.0)).left)[0] == "7.0 m/s"


def test_what_is_said_of_a_ride_that_is_not_ridden():
    def said(phase: Phase, words: str = "", *, alive: bool = True) -> list[str]:
        told = message(Sight(phase, None, words, 2.6, alive))
        return [] if told is None else texts(told.lines)

    assert said(Phase.RIDING, "armed") == []
    assert said(Phase.READY, "armed") == ["armed"]
    assert said(Phase.SILENT) == ["no picture from the ride for 3 s", "it hangs"]
    assert said(Phase.SILENT, alive=False)[1] == "its process has ended"
    assert said(Phase.OVER, "fault 1: lost") == ["fault 1: lost", "waiting for the next ride"]


def test_a_plate_is_dark_with_its_text_inside():
    picture = plate((Line("steer 2.5° right"),), 2.0)
    assert picture.shape[1] % 4 == 0
    edges = (picture[0], picture[-1], picture[:, 0], picture[:, -1])
    assert all((edge == INK).all() for edge in edges)
    assert (picture > 200).all(axis=2).sum() > 100


def test_what_is_long_is_broken_into_lines_and_made_to_fit():
    words = "fault 14: no heartbeat of the drive for 80.3 ms; allowed 80 ms, and much more of it"
    told = message(Sight(Phase.OVER, None, words, 0.0, True))
    assert told is not None
    assert " ".join(texts(told.lines)[:-1]) == words
    assert len(told.lines) == 3
    for window in ((320, 180), (640, 360), (3840, 2160)):
        rows, columns = fitting(told.lines, window[1] / 720, window).shape[:2]
        assert columns <= window[0]
        assert rows <= 0.7 * window[1]


def test_a_plate_whose_figures_change_stands_still():
    shapes = {plate((Line(text),), 1.0, least=170).shape for text in ("1", "99.9", "steer")}
    assert len(shapes) == 1
