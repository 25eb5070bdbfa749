import pytest

from bikesim.view.live.eyes import Eyes
from bikesim.view.pose import Pose


def pose(time: float) -> Pose:
    """Of a bicycle whose figures are all linear in time."""
    return Pose(time, 4.0, 0.1 * time, -0.2 * time, 0.03 * time, 4 * time, 0.5 * time, 4 * time)


def test_without_cues_the_pose_is_shown_as_it_comes():
    eyes = Eyes(0.0, ())
    assert [eyes.see(pose(t)) for t in (0.0, 0.3, 7.0)] == [pose(0.0), pose(0.3), pose(7.0)]


def test_a_delay_shows_what_was_whatever_the_times_of_the_poses():
    eyes = Eyes(0.25, ())
    time = 0.0
    for k in range(400):
        time += 0.004 + 0.03 * (k % 7 == 0)
        shown = eyes.see(pose(time))
        assert shown is not None
        if time > 0.3:
            assert tuple(shown) == pytest.approx(tuple(pose(time - 0.25)), abs=1e-12)
    assert len(eyes._past) < 100


def test_before_the_delay_is_over_the_first_pose_stands():
    eyes = Eyes(0.5, ())
    for time in (0.0, 0.2, 0.49):
        assert eyes.see(pose(time)) == pose(0.0)


def test_a_bicycle_that_begins_anew_is_seen_from_its_beginning():
    """After a fall: not the last of what was, until the time has come so far again."""
    eyes = Eyes(0.2, ())
    for k in range(100):
        eyes.see(pose(10.0 + 0.01 * k))
    for _ in range(100):
        assert eyes.see(pose(0.0)) == pose(0.0)
    for k in range(1, 100):
        shown = eyes.see(pose(0.01 * k))
        assert shown is not None
        assert shown.time == pytest.approx(max(0.0, 0.01 * k - 0.2))
    assert len(eyes._past) < 30


def test_it_is_dark_from_the_first_to_before_the_last_time():
    eyes = Eyes(0.0, ((1.0, 2.0), (3.0, 3.5)))
    times = [0.9, 1.0, 1.99, 2.0, 2.9, 3.0, 3.49, 3.5]
    assert [t for t in times if eyes.see(pose(t)) is None] == [1.0, 1.99, 3.0, 3.49]


def test_a_late_display_is_dark_late_too():
    eyes = Eyes(0.5, ((1.0, 2.0),))
    dark = [k / 100 for k in range(400) if eyes.see(pose(k / 100)) is None]
    assert (dark[0], dark[-1]) == (1.5, 2.49)


def test_a_frame_that_shows_no_newer_pose_is_no_harm():
    eyes = Eyes(0.1, ())
    for _ in range(5):
        assert eyes.see(pose(1.0)) == pose(1.0)
    shown = eyes.see(pose(1.15))
    assert shown is not None
    assert shown.time == pytest.approx(1.05)
