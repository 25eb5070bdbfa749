"""The real command in a window of a monitor that is not there: what a rider would see."""

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import cv2
import numpy as np
import pytest

from bikesim import bicycles
from bikesim.bench.display import Screen, screen_name
from bikesim.bench.profile import load_bench
from bikesim.bench.showing import Showing
from bikesim.model.haptic import BicycleState
from bikesim.view.pose import Pose

from ..draw import Shot, pictures
from .screen import SIZE, Monitor, monitor

PROFILE = """
[bus]
interface = "virtual"
channel = "CHANNEL"
[bar]
inertia = 0.2311
delay = 0.002
[drive]
kind = "cia402"
node = 5
rated_torque = 0.386
torque_unit = "uNm"
gear = 5.5
encoder_counts = 4096
torque_limit = 3.5
"""
PATH = np.stack([np.arange(-50, 200.0), 1.5 * np.sin(np.arange(-50, 200.0) / 8)], axis=1)

Picture = np.ndarray

# Processes with OpenGL in software, which take their time.
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def at(tmp_path_factory) -> Iterator[Monitor]:
    with monitor(tmp_path_factory.mktemp("screen")) as made:
        yield made


@pytest.fixture
def profile(tmp_path: Path) -> Path:
    file = tmp_path / "bench.toml"
    file.write_text(PROFILE.replace("CHANNEL", f"display {tmp_path}"))
    return file


def showing(**keys) -> Showing:
    return Showing(
        **{
            "bicycle": bicycles.load("benchmark"), "path": PATH, "roll_cue": True, "preview": None,
            "delay": 0.0, "occlusions": (), "haptics": "haptics on", "ramp_in": 1.0,
        } | keys
    )  # fmt: skip


@contextmanager
def displayed(at: Monitor, profile: Path, *more: str) -> Iterator[subprocess.Popen[str]]:
    command = [
        sys.executable, "-m", "bikesim", "bench", "display", str(profile),
        "--size", "{}x{}".format(*SIZE), "--quality", "draft", "--no-overlay", *more,
    ]  # fmt: skip
    with subprocess.Popen(
        command, env=at.environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as process:
        try:
            yield process
        finally:
            process.terminate()


def state(pose: Pose) -> BicycleState:
    zero = BicycleState(*[0.0] * len(BicycleState._fields))
    return zero._replace(**pose._asdict())


def far(one: Picture, other: Picture) -> float:
    """How far two pictures are from each other, on average, of 255."""
    return float(np.abs(one.astype(int) - other).mean())


def as_rendered(pose: Pose, **how) -> Picture:
    """Drawn off screen by MuJoCo's own renderer, as `bikesim render` does."""
    small = (SIZE[0] // 2, SIZE[1] // 2)
    [drawn] = pictures([Shot(pose, "first", size=small, **how)])
    return cv2.resize(drawn.pixels, SIZE, interpolation=cv2.INTER_LINEAR)


def ridden(screen: Screen, pose: Pose) -> Callable[[], object]:
    """A ride that goes on and on at a place."""
    return lambda: screen.show(state(pose))


def shown(at: Monitor, show: Callable[[], object], like: Picture) -> Picture:
    """Waits until the window is like a picture, while states come."""

    def good(picture: Picture) -> bool:
        show()
        return far(picture, like) < 4

    return at.until(good)


def test_the_window_shows_what_a_video_does(at: Monitor, profile: Path):
    name = screen_name(load_bench(str(profile)).bus)
    right = Pose(2.0, 4.0, 0.3, 0.1, 0.02, 8.0, 0.4, 8.0)
    left = right._replace(roll=-0.3)
    wanted = [as_rendered(pose, path=PATH) for pose in (right, left)]
    assert far(*wanted) > 20
    with displayed(at, profile):
        with Screen(name, showing().to_text()) as screen:
            for pose, like in zip((right, left), wanted, strict=True):
                shown(at, ridden(screen, pose), like)
        # The next ride's rider sees no lean, and for a while nothing.
        level = as_rendered(right._replace(roll=0.0), path=PATH)
        cues = showing(roll_cue=False, occlusions=((3.0, 4.0),))
        with Screen(name, cues.to_text()) as screen:
            shown(at, ridden(screen, right), level)
            shown(at, ridden(screen, right._replace(time=3.5)), np.zeros_like(level))
            shown(at, ridden(screen, right._replace(time=4.0)), level)


def test_the_picture_of_a_killed_ride_is_not_shown_as_if_live(at: Monitor, profile: Path):
    writer = (
        "import sys, time\nfrom bikesim.bench.display import Screen\n"
        "from bikesim.model.haptic import BicycleState\n"
        "with Screen(sys.argv[1], sys.argv[2]) as screen:\n"
        "  while True:\n    screen.show(BicycleState(*[0.0] * 15))\n    time.sleep(0.001)"
    )
    like = as_rendered(Pose(*[0.0] * 8), path=PATH)
    name = screen_name(load_bench(str(profile)).bus)
    with (
        displayed(at, profile, "--once") as display,
        subprocess.Popen(
            [sys.executable, "-c", writer, name, showing().to_text()], stderr=subprocess.DEVNULL
        ) as ride,
    ):
        live = shown(at, lambda: None, like)
        ride.send_signal(signal.SIGSTOP)
        at.until(lambda picture: picture.mean() < 0.6 * live.mean())
        ride.send_signal(signal.SIGCONT)
        shown(at, lambda: None, like)
        ride.kill()
        at.until(lambda picture: picture.mean() < 0.6 * live.mean())
        out, _ = display.communicate(timeout=60)
    assert display.returncode == 0
    assert out.startswith("ready: 640x360, draft on ")
    assert out.count("\n") == 1


def test_on_the_bench_the_screen_before_the_rider_shows_the_road(at: Monitor, profile: Path):
    name = screen_name(load_bench(str(profile)).bus)
    right = Pose(2.0, 4.0, 0.3, 0.0, 0.0, 8.0, 0.4, 8.0)
    with (
        displayed(at, profile, "--view", "bench") as display,
        Screen(name, showing().to_text()) as screen,
    ):
        assert display.stdout is not None
        display.stdout.readline()

        def still(pose: Pose, unlike: Picture | None = None) -> Picture:
            """Once it does not change any more."""
            seen = []

            def good(picture: Picture) -> bool:
                screen.show(state(pose))
                seen.append(picture)
                stands = len(seen) > 40 and all(far(picture, one) == 0 for one in seen[-20:])
                return stands and (unlike is None or far(picture, unlike) > 0)

            return at.until(good)

        one = still(right)
        other = still(right._replace(roll=-0.3), one)
    rows, columns = np.nonzero((one != other).any(axis=2))
    # Where the screen of mjcf/rig.xml is in the picture of its camera "bench", and nowhere else.
    assert (columns.min(), columns.max()) == pytest.approx((0.585 * 640, 0.735 * 640), abs=10)
    assert (rows.min(), rows.max()) == pytest.approx((0.06 * 360, 0.26 * 360), abs=10)


def test_full_screen_fills_the_monitor(at: Monitor, profile: Path):
    name = screen_name(load_bench(str(profile)).bus)
    with (
        displayed(at, profile, "--size", "320x200", "--full-screen") as display,
        Screen(name, showing().to_text()),
    ):
        assert display.stdout is not None
        assert display.stdout.readline().startswith("ready: 640x360, ")


KEYS = """
import json, sys
from bikesim.view.live.window import prepare_opengl
prepare_opengl()
import glfw
from bikesim.bench.display import ScreenReader
from bikesim.bench.onlooker import Onlooker
from bikesim.view.live.display import LiveDisplay
from bikesim.view.live.wanted import Wanted
display = LiveDisplay(Onlooker(ScreenReader(sys.argv[1])), "", Wanted(size=(320, 200)), print)
window = display._window
said = []
for key in "VVVOFFQ":
    for action in (glfw.PRESS, glfw.RELEASE):
        window._on_key(window._window, getattr(glfw, "KEY_" + key), 0, action, 0)
    glfw.poll_events()
    said.append([display._view, display._overlay, window.full_screen, window.closed])
print(json.dumps(said))
"""


def test_the_keys(at: Monitor):
    ran = subprocess.run(
        [sys.executable, "-c", KEYS, "no such ride"],
        env=at.environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    assert json.loads(ran.stdout) == [
        ["second", True, False, False],
        ["bench", True, False, False],
        ["first", True, False, False],
        ["first", False, False, False],
        ["first", False, True, False],
        ["first", False, False, False],
        ["first", False, False, True],
    ]


def test_a_signal_ends_it(at: Monitor, profile: Path):
    name = screen_name(load_bench(str(profile)).bus)
    with displayed(at, profile) as display, Screen(name, showing().to_text()):
        assert display.stdout is not None
        display.stdout.readline()
        display.terminate()
        display.communicate(timeout=60)
    assert display.returncode in (130, -signal.SIGINT)


@pytest.mark.parametrize(
    ("display", "more", "message"),
    [
        ("", (), "display: no window can be opened here: "),
        (":987", (), "display: no window can be opened here: "),
        (None, ("--monitor", "2"), "--monitor 2: there are 1, counted from 1"),
    ],
)
def test_where_there_is_no_window_it_says_so_in_a_line(
    at: Monitor, profile: Path, display: str | None, more: tuple[str, ...], message: str
):
    environment = at.environment | ({} if display is None else {"DISPLAY": display})
    ran = subprocess.run(
        [sys.executable, "-m", "bikesim", "bench", "display", str(profile), *more],
        env={key: value for key, value in environment.items() if value},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert (ran.returncode, ran.stdout) == (2, "")
    assert ran.stderr.startswith(f"bikesim: {message}")
    assert ran.stderr.count("\n") == 1
