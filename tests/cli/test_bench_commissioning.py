"""`bikesim bench calibrate` and `identify` as far as they go without a bench."""

import io

import pytest

BENCH = """\
[bus]
interface = "virtual"
channel = "nobody is here"
[bar]
inertia = 0.2311
delay = 0.002
[drive]
kind = "odrive"
node = 3
torque_constant = 0.055
torque_limit = 3.5
"""


@pytest.fixture
def bench(tmp_path) -> str:
    path = tmp_path / "mine.toml"
    path.write_text(BENCH)
    return str(path)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["calibrate", "BENCH", "--positions", "0"], "--positions 0: must be two or more angles"),
        (["calibrate", "BENCH", "--positions", "0,x"], "--positions 0,x: must be two or more"),
        (["calibrate", "BENCH", "--positions", "0,120"], "between -90 and 90 deg"),
        (["calibrate", "BENCH"], "sensor node: does not answer"),
        (["identify", "BENCH", "--torque", "0.7"], "--torque 0.7: must be above 0 and at most 0.5"),
        (["identify", "BENCH", "--duration", "1"], "--duration 1.0: must be from 5 to 300 s"),
        (["identify", "BENCH", "--added-inertia", "0"], "--added-inertia 0.0"),
        (["identify", "BENCH", "--confidence", "1"], "--confidence 1.0"),
        (["identify", "cia402-emulated", "--write"], "ships with bikesim; copy a profile"),
        (["calibrate", "cia402-emulated"], "ships with bikesim; copy a profile"),
        (["identify", "nowhere"], "unknown bench 'nowhere'"),
        (["identify", "BENCH"], "nobody answers at the terminal"),
    ],
    ids=lambda one: " ".join(one) if isinstance(one, list) else "",
)
def test_bad_input_is_one_line(cli, bench: str, monkeypatch, arguments: list[str], told: str):
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    said = cli("bench", *(bench if one == "BENCH" else one for one in arguments))
    assert said.status == 2
    assert told in said.err
    assert said.out == ""


def test_a_bench_on_which_nobody_answers(cli, bench: str, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.StringIO("\n"))
    said = cli("bench", "identify", bench)
    assert said.status == 2
    assert "nobody answers on the bus" in said.err
