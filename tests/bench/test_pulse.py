"""Row 22: the commissioning pulse finds signs, units and inertia that are not the profile's."""

import pytest

from bikesim.bench.profile import BenchSettings
from bikesim.bench.pulse import pulse_torque
from bikesim.errors import InputError

from .lockstep import CIA402, DRIVES, ODRIVE, LockStep, leaning, profile


def pulsed(bench: BenchSettings, real: BenchSettings | None = None) -> LockStep:
    step = LockStep(bench, leaning(), real=real)
    step.arm()
    try:
        step.said = step.parts.pulse()
    finally:
        step.parts.rig.close()
        # What the motor really gives: with a wrong gear that is another than was wanted.
        ratio = abs(step.plant._ratio / (bench.drive.gear * bench.drive.direction))
        assert step.plant.largest_torque <= 0.3 * ratio + 0.002  # a count of the drive
        assert step.plant.torque == 0.0
    return step


@pytest.mark.parametrize("kind", DRIVES)
@pytest.mark.parametrize("inertia", [0.0427, 0.2311, 0.5])
def test_a_bench_that_is_as_its_profile_says(kind: str, inertia: float):
    bar = {"inertia": inertia, "coulomb_friction": 0.03, "viscous_friction": 0.01}
    step = pulsed(profile(DRIVES[kind], bar=bar))
    found = float(step.said.split("inertia ")[1].split()[0])
    assert found == pytest.approx(inertia, rel=0.05)
    # It ends where it began, nearly, and at rest.
    assert abs(step.plant.steer) < 0.03


def test_the_torque_is_as_large_as_the_bar_needs():
    assert pulse_torque(profile(bar={"inertia": 5.0}).bar) == 0.3
    assert pulse_torque(profile(bar={"inertia": 0.02}).bar) < 0.1


@pytest.mark.parametrize("drive", [CIA402, ODRIVE], ids=DRIVES)
def test_a_wrong_sign(drive: dict):
    with pytest.raises(
        InputError, match="fault 22: the bar turns left under a torque to the right"
    ):
        pulsed(profile({**drive, "direction": -1}), profile(drive))


@pytest.mark.parametrize("drive", [CIA402, ODRIVE], ids=DRIVES)
@pytest.mark.parametrize("factor", [0.6, 1.5])
def test_a_wrong_gear(drive: dict, factor: float):
    geared = {**drive, "gear": factor * drive["gear"], "torque_limit": 2.0}
    wrong = profile(geared, limits={"torque": 2.0, "continuous_torque": 1.0})
    with pytest.raises(InputError, match="fault 22: the bar moves as if its inertia were"):
        pulsed(wrong, profile(drive))


@pytest.mark.parametrize("real", [0.15, 0.35])
def test_a_wrong_inertia(real: float):
    with pytest.raises(InputError, match=r"the profile has 0\.2311; allowed 0\.7 to 1\.3"):
        pulsed(profile(), profile(bar={"inertia": real}))


def test_a_bar_that_is_held():
    step = LockStep(profile(), leaning())
    step.arm()
    # The model is one for all benches with this bar.
    damping = step.plant.bar.model.dof_damping
    free = damping[0]
    damping[0] = 1000.0
    try:
        with pytest.raises(InputError, match="the bar hardly moves"):
            step.parts.pulse()
    finally:
        damping[0] = free


def test_a_pulse_proves_a_profile_until_bus_drive_or_bar_changes():
    bench = profile()
    proven = bench.commissioning
    assert profile(thresholds={"ramp_in": 2.0}).commissioning == proven
    assert profile(bar={"inertia": 0.24}).commissioning != proven
    assert profile({**CIA402, "direction": -1}).commissioning != proven
    assert profile({**CIA402, "gear": 5.4}).commissioning != proven
    for bus in (
        {"interface": "socketcan", "channel": "nobody"},
        {"interface": "virtual", "channel": "can0"},
        {"interface": "virtual", "channel": "nobody", "arguments": {"port": 5}},
    ):
        assert profile(bus=bus).commissioning != proven
    slower = {"interface": "virtual", "channel": "nobody", "bitrate": 900_000}
    assert profile(bus=slower).commissioning == proven
    polarity = {"index": 0x607E, "value": 0x60}
    mirrored = profile({**CIA402, "objects": [polarity]}).commissioning
    assert mirrored != proven
    assert profile({**CIA402, "objects": [{**polarity, "value": 0}]}).commissioning != mirrored


@pytest.mark.parametrize(
    ("index", "subindex", "what"),
    [
        (0x6072, 0, "largest torque"),
        (0x6080, 0, "largest motor speed"),
        (0x1016, 1, "heartbeat of the host"),
        (0x6007, 0, "lost connection: fault"),
        (0x1A01, 3, "TPDO2 mapping"),
        (0x6076, 0, "rated torque"),
    ],
)
def test_an_object_that_would_undo_the_set_up_is_refused(index: int, subindex: int, what: str):
    """With the emulated drive, 6072 = 5000 would let five times the rated torque through."""
    entry = {"index": index, "subindex": subindex, "value": 5000}
    with pytest.raises(InputError, match=f"{index:04X}:{subindex:02X} .{what}. is the set-up's"):
        profile({**CIA402, "objects": [entry]})
    profile({**CIA402, "objects": [{"index": 0x60E0, "value": 5000}]})
