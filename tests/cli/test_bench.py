"""bikesim bench: what is refused without a bench; with one, see tests/bench/test_processes."""

from pathlib import Path

import can
import pytest

GOOD = """
[bus]
interface = "virtual"
channel = "nobody is here"
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


@pytest.fixture
def bench(tmp_path: Path):
    def write(*changes: tuple[str, str], more: str = "") -> str:
        text = GOOD
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "bench.toml").write_text(text + more)
        return "bench.toml"

    return write


def test_help_names_the_commands(cli):
    said = cli("bench", "--help")
    assert (said.status, said.err) == (0, "")
    for name in ("check", "run", "display", "emulate"):
        assert f"• {name} " in said.out
    assert "bench" in cli("--help").out


@pytest.mark.parametrize("name", ["check", "run", "display", "emulate"])
def test_help_of_a_command(cli, name: str):
    said = cli("bench", name, "--help")
    assert (said.status, said.err) == (0, "")
    assert f"usage: bikesim bench {name}" in said.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["chek", "x"], "unknown bench command 'chek'; did you mean check?"),
        (["check"], "BENCH is missing"),
        (["display", "cia402-emulated", "--view", "firts"], "unknown --view 'firts'; did you mean"),
        (
            ["display", "cia402-emulated", "--quality", "high"],
            "unknown --quality 'high'; known: d",
        ),
        (["display", "cia402-emulated", "--size", "big"], "--size big: must be WIDTHxHEIGHT"),
        (
            ["display", "cia402-emulated", "--size", "9x9"],
            "--size 9x9: from 320x180 to 16384x1638",
        ),
        (["display", "cia402-emulated", "--monitor", "x"], "--monitor x: must be a whole number"),
        (["display", "cia402-emulatd"], "unknown bench 'cia402-emulatd'; did you mean cia402-emul"),
        (["check", "cia402-emulatd"], "unknown bench 'cia402-emulatd'; did you mean cia402-emul"),
        (["check", "none.toml"], "bench profile none.toml: no such file"),
        (["run", "cia402-emulated", "--speed", "11"], "must be at most limits.speed = 10 m/s"),
        (["run", "cia402-emulated", "--set", "start.steer_deg=5"], "start.steer_deg: a bench's"),
        (
            ["run", "cia402-emulated", "--speed", "7", "--set", "haptics.delay=0.1"],
            "102 ms of delay, that of haptics included: at most 50 ms is judged; --without-margin",
        ),
        (["run", "cia402-emulated", "--set", "haptics.scale=-1"], "-1 reverses the torque"),
        (["run", "cia402-emulated", "--set", "spede=5"], "unknown key 'spede'"),
        (["emulate", "cia402-emulated", "--rider", "nobody"], "unknown rider 'nobody'"),
        (["emulate", "cia402-emulated", "--mishaps", "none.toml"], "mishaps none.toml: no such"),
    ],
    ids=str,
)
def test_what_cannot_be(refusal, arguments: list[str], message: str):
    assert message in refusal("bench", *arguments)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("inertia = 0.2311", ""), "bench bench.toml: bar.inertia: must be given"),
        (("delay = 0.002", ""), "bench bench.toml: bar.delay: must be given"),
        (("torque_limit = 3.5", ""), "drive.torque_limit: must be given"),
        (('"uNm"', '"Nm"'), "torque_unit = 'Nm': must be 'uNm' or 'mNm'"),
        (("torque_limit = 3.5", "torque_limit = 3.0"), "limits.torque = 3.5 N m: is more than dr"),
        (("gear = 5.5", "gear = 0.2"), "is more than 10 times rated torque × gear"),
        (("node = 5", "node = 127"), "host_node = 127: is the drive's own node"),
        (('"cia402"', '"servo"'), "kind"),
        (("inertia = 0.2311", "inertia = 0.2311\nsteer_stop_deg = 40.0"), "trip_angle_deg"),
        (("[drive]", "[thresholds]\nlate_most = 0.04\n[drive]"), "late_most = 0.04 <= 0.03 must"),
        (("[drive]", "[thresholds]\nlate = 0.025\n[drive]"), "late = 0.025 <= late_most = 0.02 <="),
    ],
    ids=str,
)
def test_a_profile_that_contradicts_itself(refusal, bench, change, message: str):
    assert message in refusal("bench", "check", bench(change))


def test_no_such_interface(refusal, bench):
    profile = bench(('"virtual"', '"socketcan"'), ('"nobody is here"', '"can99"'))
    assert "bus socketcan can99: cannot be opened: " in refusal("bench", "check", profile)
    assert "cannot be opened" in refusal("bench", "run", profile, "--uncommissioned")
    assert "cannot be opened" in refusal("bench", "emulate", profile)


def test_nobody_answers(cli, bench):
    said = cli("bench", "run", bench(), "--uncommissioned", "-o", "r.h5")
    assert said.status == 2
    assert said.err == (
        "bikesim: nobody answers on the bus within 0.25 s: power, wiring, bus.bitrate\n"
    )
    assert not Path("r.h5").exists()


def test_check_is_red_where_nobody_answers(cli, bench):
    said = cli("bench", "check", bench())
    assert said.status == 1
    assert "RED sensor node: frames of 0x110 0 a second 1000" in " ".join(said.out.split())
    assert not Path("runs").exists()


def test_too_much_for_the_bus(refusal, bench):
    slow = bench(('interface = "virtual"', 'interface = "virtual"\nbitrate = 500_000'))
    for command in ("check", "run"):
        assert "1000 Hz does not fit on 500 kbit/s" in refusal("bench", command, slow)


def test_never_commissioned(refusal, bench):
    message = refusal("bench", "run", bench())
    assert "fault 22: bench.toml: it never passed the commissioning pulse" in message
    changed = bench(more="").replace(".toml", "") + ".toml"
    text = Path(changed).read_text()
    Path(changed).write_text('commissioned = "0123456789ab"\n' + text)
    assert "its bus, bar or drive changed since" in refusal("bench", "run", changed)


def test_a_speed_without_margin_must_be_wanted_twice(cli, refusal, bench):
    light = bench(("inertia = 0.2311", "inertia = 0.0427"), ("delay = 0.002", "delay = 0.02"))
    arguments = ("bench", "run", light, "--uncommissioned", "--speed", "7", "-o", "r.h5")
    assert "no margin at 7 m/s with 0.0427 kg m² and 20 ms of delay" in refusal(*arguments)
    assert "no margin" in refusal(*arguments, "--without-margin")
    said = cli(*arguments, "--without-margin", "--without-margin")
    assert "nobody answers" in said.err


def test_a_record_that_is_there_is_not_replaced(refusal, bench):
    Path("r.h5").write_text("mine")
    Path("s.blf").write_text("mine")
    run = ("bench", "run", bench(), "--uncommissioned", "-o")
    # Nobody is on this bus: so it is known before anything is looked for there.
    assert "r.h5: is already there; --force replaces it" in refusal(*run, "r.h5")
    assert "s.blf: is already there; --force replaces it" in refusal(*run, "s.h5")
    assert Path("r.h5").read_text() == "mine"


def test_a_mishap_that_is_none(refusal):
    Path("m.toml").write_text('[[mishaps]]\nkind = "earthquake"\ntime = 1.0\n')
    assert "mishaps m.toml: mishaps.kind = 'earthquake': must be" in refusal(
        "bench", "emulate", "cia402-emulated", "--mishaps", "m.toml"
    )


def test_an_emulated_bench_has_its_own_end_of_the_bus(cli, bench):
    """As on a line of an SLCAN adapter, of which each side has one."""
    with (
        can.Bus(interface="virtual", channel="its end") as its_end,
        can.Bus(interface="virtual", channel="nobody is here") as the_hosts,
    ):
        said = cli("bench", "emulate", bench(), "--channel", "its end", "--duration", "0.2")
        assert (said.status, said.err) == (0, "")
        assert "on bus virtual its end, " in said.out
        came = its_end.recv(0)
        assert came is not None
        assert came.arbitration_id == 0x110
        assert the_hosts.recv(0) is None


@pytest.mark.parametrize("force", [(), ("--force",)])
@pytest.mark.parametrize("more", [(), ("--bicycle", "own.toml"), ("--path", "own.csv")])
def test_what_a_ride_reads_is_not_written_over(refusal, bench, more: tuple[str, ...], force):
    name = more[1] if more else bench()
    bench()
    if more:
        Path(name).write_text("mine")
    before = Path(name).read_text()
    run = ("bench", "run", "bench.toml", "--uncommissioned", *more, *force, "-o", name)
    assert f"{name}: would replace what this command needs" in refusal(*run)
    assert Path(name).read_text() == before


def test_attempts_have_files_of_their_own(refusal, bench):
    Path("r-3.h5").write_text("mine")
    run = ("bench", "run", bench(), "--uncommissioned", "-o", "r.h5", "--attempts")
    assert "r-3.h5: is already there; --force replaces it" in refusal(*run, "3")
    assert "--attempts 0: must be 1 to 100" in refusal(*run, "0")
