"""The excitation on an emulated bench in lock-step, through its own frames."""

import pytest

from bikesim.bench.frame import Frame
from bikesim.bench.identify import identify_bar
from bikesim.bench.identify_bench import excite_armed, proposed
from bikesim.bench.identify_excitation import Excitation
from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario

from .lockstep import DRIVES, LockStep, profile

BAR = {"inertia": 0.2, "coulomb_friction": 0.03, "viscous_friction": 0.02}


@pytest.mark.parametrize("drive", DRIVES)
def test_a_bench_that_is_not_what_its_profile_says(drive: str):
    """The profile is wrong by a quarter; what is identified is what the bar is."""
    here = LockStep(
        profile(DRIVES[drive]), Scenario(), real=profile(DRIVES[drive], bar={**BAR, "delay": 0.0})
    )
    here.parts.arm()
    try:
        record = excite_armed(here.parts, Excitation(0.5, 6.0, 0.2311))
    finally:
        here.parts.rig.close()
    found = identify_bar([record])
    for name, true in BAR.items():
        figure = getattr(found, name)
        assert figure.low <= true <= figure.high, figure
    assert found.delay.high < 1.2e-3
    assert here.plant.largest_torque <= 0.5
    assert here.plant.torque == 0
    entries = proposed(found)
    assert entries["bar.inertia"] == pytest.approx(0.2, rel=0.01)
    assert entries["bar.delay"] >= found.delay.high


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"direction": -1}, "fault 22: the bar turns left under a torque to the right"),
        ({"gear": 1.0}, "fault 22: the bar moves as if its inertia were"),
    ],
    ids=str,
)
def test_signs_and_units_are_proven_with_less_torque(drive: str, wrong: dict, told: str):
    """The gear is 5.5 and 4 in truth: a motor that gives so many times what is commanded."""
    real = profile(DRIVES[drive], bar=BAR)
    as_told = profile({**DRIVES[drive], **wrong}, bar=BAR, limits={"continuous_torque": 0.3})
    here = LockStep(as_told, Scenario(), real=real)
    here.parts.arm()
    with pytest.raises(InputError, match=told):
        excite_armed(here.parts, Excitation(0.5, 6.0, 0.2))
    here.parts.rig.close()
    ratio = 1.0 if "direction" in wrong else DRIVES[drive]["gear"]
    assert 0.2 < here.plant.largest_torque / ratio <= 0.305
    assert abs(here.plant.steer) < 0.2
    assert here.plant.torque == 0


def test_weights_on_the_bar_are_allowed_for():
    """As much again three times; without being told of them the bar is another one."""
    here = LockStep(
        profile(bar=BAR), Scenario(), real=profile(bar={**BAR, "inertia": 4 * BAR["inertia"]})
    )
    here.parts.arm()
    record = excite_armed(here.parts, Excitation(0.5, 1.0, 0.2), 3 * BAR["inertia"])
    assert record.added_inertia == 3 * BAR["inertia"]
    with pytest.raises(InputError, match=r"the profile has 0\.2000; allowed 0\.33 to 3 of that"):
        excite_armed(here.parts, Excitation(0.5, 1.0, 0.2))
    here.parts.rig.close()


def test_an_emergency_stop_ends_it():
    here = LockStep(profile(), Scenario())
    here.parts.arm()

    def pressed(frame: Frame, time: float):
        if time > 1.0:
            here.plant.node.estop_closed = False
        return (frame,)

    here.sim.tamper = pressed
    with pytest.raises(InputError, match="fault 21"):
        excite_armed(here.parts, Excitation(0.5, 10.0, 0.2311))
    here.parts.rig.close()
    assert here.plant.torque == 0
    assert here.parts.rig.disabled is True
