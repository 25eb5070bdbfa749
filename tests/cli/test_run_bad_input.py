import os
from pathlib import Path

import pytest

from bikesim.experiment.keys import scenario_keys

SHORT = ("--duration", 0.1, "--output", "run.h5")


@pytest.fixture
def refused(refusal, tmp_path: Path):
    """The one line for a run that is refused, and leaves nothing."""

    def call(*arguments: object) -> str:
        before = set(tmp_path.rglob("*"))
        message = refusal("run", *SHORT, *arguments)
        assert set(tmp_path.rglob("*")) == before
        return message

    return call


OPTIONS = [
    (["--speed", "abc"], "--speed abc: must be a number"),
    (["--speed=abc"], "--speed=abc: must be a number"),
    (["--speed", ""], "--speed : must be a number"),
    (["--speed", "nan"], "speed = nan: must be a finite number"),
    (["--speed", "inf"], "speed = inf: must be a finite number"),
    (["--speed", -1], "speed = -1.0: must be at least 0 and at most 30"),
    (["--speed", 31], "speed = 31.0: must be at least 0 and at most 30"),
    (["--seed", 1.5], "--seed 1.5: must be a whole number"),
    (["--seed", -1], "seed = -1: must be at least 0"),
    (["--seed", 2**63], "must be at least 0 and below 9.22337e+18"),
    (["--duration", 0], "duration = 0.0: must be above 0 and at most 86400"),
    (["--duration", 1e9], "must be above 0 and at most 86400"),
    (["--duration", 1e-4], "must be at least one loop period, 0.001 s"),
    (["--gravity", 0], "gravity = 0.0: must be above 0 and at most 30"),
    (["--period", 1], "period = 1.0: must be at least 0.0001 and at most 0.1"),
    (
        ["--physics-step", 0.0003],
        "physics_step = 0.0003 s: the loop period, 0.001 s, must be",
    ),
    (["--physics-step", 0.002], "physics_step = 0.002 s: the loop period, 0.001 s, must be a mult"),
    (["--physics-step", 0], "physics_step = 0.0: must be at least 1e-05 and at most 0.01"),
    (["--law", "papr"], "law = 'papr': must be 'paper', 'momentum' or 'off'"),
    (["--rider", "humn"], "unknown rider 'humn'; did you mean human?"),
    (["--rider", "schwab2013-183"], "did you mean schwab2013-18"),
    (["--rig", "idael"], "unknown rig 'idael'; did you mean ideal?"),
    (["--rig", "zzz"], "known: can1khz, delft2013, ideal, phobos"),
    (["--rig", "nix.toml"], "rig nix.toml: no such file or directory"),
    (["--bicycle", "benchmrk"], "unknown bicycle 'benchmrk'; did you mean benchmark?"),
    (["--bicycle", "nix.txt"], "nix.txt: no such bicycle file"),
    (["--roll-deg", 95], "start.roll_deg = 95.0: must be above -90 and below 90"),
    (["--push", "3"], "--push 3: must be TIME:IMPULSE in s and N s, such as 5:10"),
    (["--push", "a:b"], "--push a:b: must be TIME:IMPULSE"),
    (["--push", "1:nan"], "pushes.impulse = nan: must be a finite number"),
    (["--push", "-1:3"], "pushes.time = -1.0: must be at least 0"),
    (["--set", "foo"], "--set foo: must be KEY=VALUE, such as rider.visual_delay=0.3"),
    (["--set", "=3"], "--set =3: must be KEY=VALUE"),
    (["--set", "sped=3"], "unknown key 'sped'; did you mean speed"),
    (["--set", "a.b.c=3"], "unknown key 'a'"),
    (["--set", "speed.x=3"], "speed = {'x': 3}: must be a number"),
    (["--set", "rider.roll_gain=much"], "rider.roll_gain = 'much': must be a number"),
    (["--set", "rig.angle_nois=1"], "unknown key of [rig] 'angle_nois'; did you mean angle_noise"),
    (["--rider", "hands-off", "--set", "rider.roll_gain=1"], "rider hands-off has no such figure"),
    (["--rider", "schwab2013-184", "--set", "rider.k_phi=1"], "it has: roll_gain, roll_rate_gain"),
    (["--set", "rig.filter_cutoff=4000"], "must be below 3141.59 rad/s, half the sampling freq"),
    (["--set", "rig.rotor_inertia=5"], "rig.rotor_inertia = 5.0 kg m²: must be below the whole"),
    (["--set", "rig.sensor_delay=1e9"], "rig.sensor_delay = 1000000000.0: must be at least 0"),
    (["--set", "rig.angle_resolution=1e-320"], "must be 0 (none) or at least 1e-12"),
    (["--set", "rider.arm_stiffness=1e300"], "must be at least 0 and at most 10000"),
    (["--path", "circel"], "unknown path.kind 'circel'; did you mean circle?"),
    (["--path", "nix.csv"], "path.file nix.csv: no such file or directory"),
    (["--path", "circle", "--set", "path.radius=1"], "path.radius = 1: must be at least 2 and at"),
    (["--set", "path.radius=9"], "path.radius = 9: kind straight has no such figure"),
    (["--path", "lane-change", "--set", "path.length=2"], "path: bends with a radius of 0.49 m"),
    (["--set", "start.steer_deg=60"], "start.steer_deg = 60.0: must be within the rig's stops"),
    (["--set", "haptics.delay=0.0001"], "haptics.delay = 0.0001 s: must be 0 or at least half"),
    (["--set", 'disturbances=[{kind="gus"}]'], "unknown disturbances.kind 'gus'; did you mean"),
    (["--set", "guard.torque_limit=0"], "guard.torque_limit = 0: must be above 0 and at most 100"),
    (["--set", "guard.fall_roll_deg=90"], "must be above 0 and below 90"),
    (["--sped", 3], "unknown option --sped; did you mean --speed"),
    (["--spedd=3", "--law", "off"], "unknown option --spedd; did you mean --speed"),
    (["-x"], "unknown option -x (bikesim run --help)"),
    (["--no-json"], "unknown option --no-json; did you mean --json?"),
    (["--speed"], "--speed: a value is missing (bikesim run --help)"),
    (["nix.toml"], "scenario nix.toml: no such file or directory"),
    (["nix.toml", "b.toml"], "unexpected argument b.toml"),
    (["--output", "/proc/x.h5"], "/proc/x.h5: cannot be written"),
    (["--output", "/dev/null", "--force"], "/dev/null: is not a plain file"),
    (["--output", "."], ".: is a folder; give the name of a file"),
    (["--output", "x" * 300], "cannot be written: file name too long"),
]


@pytest.mark.parametrize(("arguments", "message"), OPTIONS, ids=[str(a) for a, _ in OPTIONS])
def test_an_option_that_cannot_be(refused, arguments: list, message: str):
    assert message in refused(*arguments)


FILES = {
    "sped = 3": "unknown key 'sped'; did you mean speed",
    "zzz = 3": "unknown key 'zzz'; known: bicycle, gravity, speed",
    "[rider]\nvisual_dealy = 1": "key of [rider] 'visual_dealy'; did you mean visual_delay or",
    "[rig]\nangle_res = 1": "unknown key of [rig] 'angle_res'; did you mean angle_",
    "[start]\nroll = 1": "unknown key of [start] 'roll'; did you mean roll_deg?",
    "[guard]\nlimit = 1": "unknown key of [guard] 'limit'; did you mean torque_limit?",
    "[[pushes]]\ntime = 1\nimpulse = 2\nwidth = 3": "unknown key of [pushes] 'width'; known: time",
    "[[pushes]]\ntme = 1": "unknown key of [pushes] 'tme'; did you mean time?",
    "[[pushes]]\ntime = 1": "pushes.impulse: must be given",
    "[[pushes]]\ntime = 1\nimpulse = 2\nduration = 0": "pushes.duration = 0: must be at least",
    "[pushes]\ntime = 1\nimpulse = 2": "must be a list",
    "pushes = 3": "pushes = 3: must be a list",
    "pushes = [3]": "pushes.0 = 3: must be a table",
    'speed = "fast"': "speed = 'fast': must be a number",
    'speed = "3"': "speed = '3': must be a number",
    "speed = true": "speed = True: must be a number",
    "speed = nan": "speed = nan: must be a finite number",
    "[speed]\nx = 3": "speed = {'x': 3}: must be a number",
    "speed = [3]": "speed = [3]: must be a number",
    "speed = 1979-05-27": "must be a number",
    "seed = 1.5": "seed = 1.5: must be a whole number",
    "bicycle = 3": "bicycle = 3: must be text",
    "rider = 3": "rider = 3: must be a name or a table",
    "rig = [1]": "rig = [1]: must be a name or a table",
    "start = 1": "start = 1: must be a table",
    'guard = "off"': "guard = 'off': must be a table",
    "[rider]\nname = 3": "rider.name = 3: must be text",
    "[rig]\nname = 3": "rig.name = 3: must be text",
    '[rider]\nname = "hands-off"\narm_damping = 1': "rider hands-off has no such figure",
    'law = "papier"': "law = 'papier': must be 'paper', 'momentum' or 'off'",
    "speed_profile = [[0, 1], [0, 2]]": "speed_profile: times must rise from pair to pair",
    "speed_profile = [[0, 1, 3]]": "speed_profile.0 = [0, 1, 3]: must be a list of 2",
    "speed_profile = [[0]]": "speed_profile.0.1: must be given",
    "speed_profile = [[0, 99]]": "speed_profile.0.1 = 99: must be at most 30",
    "speed_profile = [3]": "speed_profile.0 = 3: must be a list",
    "speed = ": "not TOML: Invalid value (at ",
    "speed = 1\nspeed = 2": "not TOML: Cannot overwrite a value (at ",
}


@pytest.mark.parametrize(("text", "message"), FILES.items(), ids=list(FILES))
def test_a_scenario_file_that_cannot_be_is_named(refused, tmp_path: Path, text: str, message: str):
    (tmp_path / "s.toml").write_text(text)
    said = refused("s.toml")
    assert said.startswith("bikesim: scenario s.toml: ")
    assert message in said


def test_a_binary_file_is_no_scenario(refused, tmp_path: Path):
    (tmp_path / "s.toml").write_bytes(bytes(range(256)))
    assert "s.toml: is not a text file (UTF-8)" in refused("s.toml")


DEEP = "a = " + "[" * 5000


def test_a_scenario_that_is_nested_too_deeply(refused, tmp_path: Path):
    (tmp_path / "s.toml").write_text(DEEP)
    assert "scenario s.toml: not TOML: nested too deeply" in refused("s.toml")


def test_a_rig_that_is_nested_too_deeply(refused, tmp_path: Path):
    (tmp_path / "rig.toml").write_text(DEEP)
    assert "rig rig.toml: not TOML: nested too deeply" in refused("--rig", "rig.toml")


def test_an_option_that_is_nested_too_deeply(refused):
    assert "--set: [[[" in refused("--set", DEEP.replace(" ", ""))


@pytest.mark.parametrize("scenario", ['rig = "bad.toml"', '[rig]\nname = "bad.toml"'])
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("inerta = 1", "rig bad.toml: unknown key of [rig] 'inerta'; did you mean inertia or"),
        ("inertia = -1", "rig bad.toml: rig.inertia = -1: must be at least 0.0001 and at most"),
    ],
)
def test_what_is_wrong_in_a_rig_file_is_told_of_it(
    refused, tmp_path: Path, scenario: str, text: str, message: str
):
    (tmp_path / "s.toml").write_text(scenario)
    (tmp_path / "bad.toml").write_text(text)
    assert message in refused("s.toml")
    assert message in refused("--rig", "bad.toml")


def test_a_pipe_is_no_scenario(refused, tmp_path: Path):
    os.mkfifo(tmp_path / "pipe")
    assert "scenario pipe: is not a scenario file" in refused("pipe")


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null"])
def test_a_device_is_no_scenario(refused, path: str):
    assert f"scenario {path}: is not a scenario file" in refused(path)


def test_a_byte_order_mark_is_no_error(cli, tmp_path: Path):
    (tmp_path / "s.toml").write_bytes(b"\xef\xbb\xbfspeed = 4\n")
    assert cli("run", "s.toml", *SHORT).status == 0


def test_a_folder_is_no_scenario(refused, tmp_path: Path):
    (tmp_path / "s.toml").mkdir()
    assert "scenario s.toml: is a folder; give a scenario file in it" in refused("s.toml")


def test_what_the_option_says_is_not_blamed_on_the_file(refused, tmp_path: Path):
    (tmp_path / "s.toml").write_text("speed = 3")
    assert refused("s.toml", "--speed", 99).startswith("bikesim: speed = 99.0")


def test_an_output_below_a_file(refused, tmp_path: Path):
    (tmp_path / "file").write_text("")
    said = refused("--output", "file/run.h5")
    assert "file/run.h5: cannot be written: file is not a folder" in said


BICYCLE = "[parameters]\nw = 1"


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("b.txt", "", "b.txt"),
        ("b.txt", "w=1.0\n", "b.txt: lacks"),
        ("b.toml", "w = ", "b.toml"),
        ("b.toml", BICYCLE, "b.toml"),
    ],
)
def test_a_bicycle_file_that_cannot_be_is_named(refused, tmp_path, name, text, message):
    (tmp_path / name).write_text(text)
    assert message in refused("--bicycle", name)


def test_a_mass_matrix_that_is_not_positive_definite(refused, tmp_path, shared):
    text = (shared / "reference/bicycles/BenchmarkBenchmark.txt").read_text()
    lines = ["mB=-500" if line.startswith("mB") else line for line in text.splitlines()]
    (tmp_path / "b.txt").write_text("\n".join(lines))
    assert "b.txt: " in refused("--bicycle", "b.txt")


@pytest.mark.parametrize("text", ["inertia = ", "inertia = -1", "intertia = 1"])
def test_a_rig_file_that_cannot_be(refused, tmp_path: Path, text: str):
    (tmp_path / "rig.toml").write_text(text)
    assert "rig" in refused("--rig", "rig.toml")


NUMBERS = [
    key.key
    for key in scenario_keys()
    if key.default.replace(".", "").isdigit() and not key.key.startswith("pushes.")
]


@pytest.mark.parametrize("value", ["1e300", "-1e300", "nan", "inf"])
@pytest.mark.parametrize("key", NUMBERS)
def test_no_number_of_a_scenario_is_taken_at_any_size(refused, key: str, value: str):
    said = refused("--set", f"{key}={value}")
    assert f"{key} = " in said
