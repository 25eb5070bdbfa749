import subprocess
import sys
import time
import uuid

import pytest

from bikesim import bicycles
from bikesim.bench.bus import BusSettings
from bikesim.bench.display import Screen, ScreenReader, screen_name
from bikesim.errors import InputError
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


def test_who_looks_sees_ride_after_ride(name: str):
    reader = ScreenReader(name)
    rides = []
    for roll in (0.1, 0.2):
        with Screen(name, about=f"roll {roll}") as screen:
            screen.show(state(roll))
            seen = reader.look()
            assert seen is not None
            assert seen[1].roll == roll
            assert (reader.about, reader.alive) == (f"roll {roll}", True)
            rides.append(reader.ride)
            screen.say(f"ended at {roll}")
        assert reader.look() is None
        assert (reader.ride, reader.words, reader.about) == (None, f"ended at {roll}", "")
    assert len(set(rides)) == 2


def test_who_looked_at_a_killed_ride_sees_the_next(name: str):
    code = (
        "import os\nfrom bikesim.bench.display import Screen\n"
        "from bikesim.model.haptic import BicycleState\n"
        f"s = Screen({name!r})\ns.show(BicycleState(*[0.5] * 15))\nprint(flush=True)\ninput()\n"
        "os.kill(os.getpid(), 9)"
    )
    reader = ScreenReader(name)
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True,
    ) as killed:  # fmt: skip
        assert killed.stdout is not None
        killed.stdout.readline()
        seen = reader.look()
        assert seen is not None
        assert seen[1].roll == 0.5
        with pytest.raises(
            InputError, match=f"a ride is on this bus already: process {killed.pid}"
        ):
            Screen(name)
        killed.communicate("\n")
    assert not reader.alive
    deadline = time.monotonic() + 10
    while ScreenReader(name)._find():  # Python tidies up after a process, a little later
        assert time.monotonic() < deadline
        time.sleep(0.01)
    with Screen(name) as screen:
        screen.show(state(0.25))
        deadline = time.monotonic() + 10
        while (seen := reader.look()) is None or seen[1].roll != 0.25:
            assert time.monotonic() < deadline
            time.sleep(0.01)
    reader.close()


def test_what_refused_a_ride_is_said(name: str):
    reader = ScreenReader(name)

    def refused() -> None:
        with Screen(name) as screen:
            screen.say("the drive is being armed")
            reader.look()
            raise InputError("fault 25: measured torque not zero")

    with pytest.raises(InputError):
        refused()
    assert reader.look() is None
    assert reader.words == "fault 25: measured torque not zero"


def test_words_that_are_too_long_are_cut_short(name: str):
    with Screen(name) as screen:
        screen.say("no torque: " + 1000 * "é")
        screen.show(state(0.0))
        reader = ScreenReader(name)
        reader.look()
        assert reader.words.startswith("no torque: éé")
        screen.say("short")
        assert reader.words == "short"
        reader.close()
