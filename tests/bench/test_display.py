import subprocess
import sys
import uuid

import pytest

from bikesim import bicycles
from bikesim.bench.bus import BusSettings
from bikesim.bench.display import Screen, ScreenReader, screen_name
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law


@pytest.fixture
def name() -> str:
    return f"bikesim-test-{uuid.uuid4().hex[:8]}"


def state(roll: float) -> BicycleState:
    return HapticBicycle(bicycles.load("benchmark"), Law.PAPER).start(roll=roll, speed=3.0)


def test_what_is_shown_is_seen_with_a_count_that_rises(name: str):
    reader = ScreenReader(name)
    assert reader.look() is None
    with Screen(name) as screen:
        assert reader.look() is None
        counts = []
        for roll in (0.1, -0.2, 0.3):
            screen.show(state(roll))
            seen = reader.look()
            assert seen is not None
            counts.append(seen[0])
            assert seen[1] == state(roll)
        assert counts == sorted(set(counts))
        reader.close()
    assert ScreenReader(name).look() is None


def test_half_a_picture_is_not_shown(name: str):
    with Screen(name) as screen:
        screen.show(state(0.1))
        screen._buffer[0] = screen._buffer[0] + 1  # as in the middle of a show
        reader = ScreenReader(name)
        assert reader.look() is None
        reader.close()


def test_a_screen_that_a_killed_ride_left_is_taken_over(name: str):
    killed = (
        "import os\nfrom bikesim.bench.display import Screen\n"
        f"Screen({name!r})\nos.kill(os.getpid(), 9)"
    )
    subprocess.run([sys.executable, "-c", killed], capture_output=True, check=False)
    with Screen(name) as screen:
        screen.show(state(0.1))


def test_another_process_that_looked_does_not_take_it_away(name: str):
    with Screen(name) as screen:
        screen.show(state(0.25))
        look = (
            "from bikesim.bench.display import ScreenReader\n"
            f"r = ScreenReader({name!r})\nprint(r.look()[1].roll)\nr.close()"
        )
        ran = subprocess.run(
            [sys.executable, "-c", look], capture_output=True, text=True, check=True
        )
        assert (float(ran.stdout), ran.stderr) == (0.25, "")
        screen.show(state(0.5))
        seen = ScreenReader(name).look()
        assert seen is not None
        assert seen[1].roll == 0.5


def test_a_bus_has_its_own_screen():
    one, other = (
        screen_name(BusSettings(interface="udp_multicast", channel=channel))
        for channel in ("239.74.163.2", "239.74.163.3")
    )
    assert one != other
