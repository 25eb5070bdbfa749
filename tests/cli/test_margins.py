from pathlib import Path

import pytest


def test_json_has_the_published_delays(cli):
    table = cli("margins", "--inertia", 0.0427, "--speeds", "5,7", "--json").json
    five, seven = (row["delay_margin_s"] for row in table["speeds"])
    # Half a period of the hold is in the loop besides.
    assert five == pytest.approx(0.0183 - 0.0005, abs=2e-4)
    assert seven == pytest.approx(0.0130 - 0.0005, abs=2e-4)
    assert table["period_s"] == 0.001
    assert table["inertia_kg_m2"] == 0.0427


def test_a_rigs_figures_and_what_replaces_them(cli):
    table = cli("margins", "--rig", "phobos", "--speeds", 7, "--json").json
    assert table["delay_s"] == pytest.approx(0.013)
    assert table["motor_lag_s"] == 0.004
    assert table["speeds"][0]["margin"] is False
    less = cli("margins", "--rig", "phobos", "--delay", 0.001, "--speeds", 7, "--json").json
    assert less["delay_s"] == 0.001
    gained = less["speeds"][0]["delay_margin_s"] - table["speeds"][0]["delay_margin_s"]
    assert gained == pytest.approx(0.012, abs=1e-6)


def test_a_coupling_is_in_the_table(cli):
    told = cli("margins", "--inertia", 0.0427, "--delay", 0.01, "--speeds", "7", "--coupling", 1)
    assert told.status == 0
    assert "0.1884 kg m² simulated" in told.out
    assert "margin at every speed" in told.out
    assert Path("margins-ideal.png").stat().st_size > 5000


def test_a_table_names_the_speeds_without_margin(cli):
    told = cli("margins", "--inertia", 0.0427, "--delay", 0.01, "--speeds", "3.5,10")
    assert "no margin at 10 m/s" in told.out


def test_haptics_off_has_no_limit(cli):
    table = cli("margins", "--law", "off", "--speeds", 5, "--json").json
    assert table["speeds"][0]["delay_margin_s"] is None
    assert table["speeds"][0]["margin"] is True


def test_a_figure_that_is_there_is_not_replaced(cli):
    Path("a.png").write_text("mine")
    said = cli("margins", "--speeds", 5, "--figure", "a.png")
    assert said.status == 2
    assert Path("a.png").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--law", "pd"], "--law pd: must be one of paper, momentum, off"),
        (["--delay", "-1"], "--delay -1.0: must be from 0 to 1 s"),
        (["--inertia", "0"], "--inertia 0.0: must be from 0.0001 to 100 kg m²"),
        (["--coupling", "2"], "--coupling 2.0: must be from 0 to 1"),
        (["--coupling", "0.5"], "adds inertia and takes none away"),
        (["--filter", "4000"], "below 3141.59 rad/s"),
        (["--rig", "nobody"], "unknown rig 'nobody'"),
        (["--speeds", "fast"], "--speeds fast"),
        (["--figure", "a.txt"], "cannot draw to '.txt'"),
    ],
    ids=lambda one: " ".join(one) if isinstance(one, list) else "",
)
def test_bad_input_is_one_line(cli, arguments: list[str], told: str):
    said = cli("margins", *arguments)
    assert said.status == 2
    assert told in said.err
    assert said.err.count("\n") == 1
    assert said.out == ""


def test_of_a_bench(cli):
    table = cli("bench", "margins", "cia402-emulated", "--speeds", "5", "--json").json
    assert table["delay_s"] == 0.002
    assert table["speeds"][0]["margin"] is True


LIGHT = """\
[bus]
interface = "virtual"
channel = "x"
[bar]
inertia = 0.1
delay = 0.002
[drive]
kind = "odrive"
node = 3
torque_constant = 0.055
torque_limit = 3.5
"""


def test_of_a_bench_with_another_coupling(cli):
    Path("light.toml").write_text(LIGHT)
    said = cli("bench", "margins", "light.toml", "--coupling", "0.5", "--speeds", "5", "--json")
    assert said.json["coupling"]["inertia_kg_m2"] == pytest.approx(0.5 * (0.2310850117 - 0.1))
    assert said.json["speeds"][0]["inertia_error_1_s"] < 0.5
