import subprocess
import sys
import uuid

import pytest

from bikesim import bicycles
from bikesim.bench.display import Screen, ScreenReader
from bikesim.bench.onlooker import Onlooker, Phase
from bikesim.bench.showing import Showing
from bikesim.errors import InputError
from bikesim.model.haptic import BicycleState, HapticBicycle
from bikesim.model.law import Law


@pytest.fixture
def name() -> str:
    return f"bikesim-test-{uuid.uuid4().hex[:8]}"


def about(haptics: str = "haptics on") -> str:
    bicycle = bicycles.load("benchmark")
    return Showing(bicycle, None, True, None, 0.0, (), haptics, 1.0).to_text()


def state() -> BicycleState:
    return HapticBicycle(bicycles.load("benchmark"), Law.PAPER).start(speed=3.0)


def test_a_ride_from_before_it_to_after_it(name: str):
    onlooker = Onlooker(ScreenReader(name))
    assert onlooker.look(0.0).phase is Phase.NONE
    assert onlooker.showing is None
    with Screen(name, about()) as screen:
        screen.say("the drive is being armed")
        sight = onlooker.look(1.0)
        assert (sight.phase, sight.state, sight.words) == (
            Phase.READY, None, "the drive is being armed",
        )  # fmt: skip
        # However long it takes to begin.
        assert onlooker.look(100.0).phase is Phase.READY
        screen.show(state())
        sight = onlooker.look(101.0)
        assert (sight.phase, sight.state) == (Phase.RIDING, state())
        screen.say("end of run")
    sight = onlooker.look(102.0)
    assert (sight.phase, sight.state, sight.words) == (Phase.OVER, state(), "end of run")


def test_a_state_that_stays_is_live_for_less_than_a_second(name: str):
    with Screen(name, about()) as screen:
        onlooker = Onlooker(ScreenReader(name))
        screen.show(state())
        phases = [onlooker.look(time).phase for time in (10.0, 10.99, 11.01, 13.0)]
        assert phases == [Phase.RIDING, Phase.RIDING, Phase.SILENT, Phase.SILENT]
        assert onlooker.look(13.0).silence == 3.0
        assert onlooker.look(13.0).alive
        screen.show(state())
        assert onlooker.look(13.1).phase is Phase.RIDING


def test_a_process_that_was_killed_before_it_rode_is_not_waited_for(name: str):
    code = (
        f"import os\nfrom bikesim.bench.display import Screen\ns = Screen({name!r}, {about()!r})\n"
        "print(flush=True)\ninput()\nos.kill(os.getpid(), 9)"
    )
    onlooker = Onlooker(ScreenReader(name))
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True,
    ) as killed:  # fmt: skip
        assert killed.stdout is not None
        killed.stdout.readline()
        assert onlooker.look(0.0).phase is Phase.READY
        killed.communicate("\n")
    sight = onlooker.look(0.1)
    assert (sight.phase, sight.alive) == (Phase.SILENT, False)


def test_another_ride_says_anew_what_it_is(name: str):
    onlooker = Onlooker(ScreenReader(name))
    said = []
    for haptics in ("haptics on", "haptics off"):
        with Screen(name, about(haptics)):
            assert onlooker.look(0.0).phase is Phase.READY
            assert onlooker.showing is not None
            said.append(onlooker.showing.haptics)
        onlooker.look(0.1)
    assert said == ["haptics on", "haptics off"]


def test_a_ride_of_another_version_is_refused(name: str):
    with Screen(name, '{"version": 0}'), pytest.raises(InputError, match="of another version"):
        Onlooker(ScreenReader(name)).look(0.0)


def test_who_fell_is_shown_upright_again_until_the_next_attempt(name: str):
    with Screen(name, about()) as screen:
        onlooker = Onlooker(ScreenReader(name))
        screen.show(state())
        assert onlooker.look(1.0).phase is Phase.RIDING
        screen.stand("fell to the right")
        sight = onlooker.look(2.0)
        assert (sight.phase, sight.state, sight.words) == (Phase.READY, None, "fell to the right")
        assert onlooker.look(60.0).phase is Phase.READY
        screen.show(state())
        assert onlooker.look(61.0).phase is Phase.RIDING
        screen.stand("fell to the left")
        assert onlooker.look(62.0).phase is Phase.READY
    assert onlooker.look(63.0) == (Phase.OVER, None, "fell to the left", 1.0, False)
