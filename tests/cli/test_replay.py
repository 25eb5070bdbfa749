import gzip
import os
from pathlib import Path

import pytest

RIG = ("--gravity", 9.80665, "--torque-limit", 10.78125)
KEYS = {
    "rows", "compared_rows", "max_torque_error_N_m", "rms_torque_error_N_m",
    "max_one_step_roll_error_rad",
}  # fmt: skip


@pytest.fixture(scope="session")
def recording(shared: Path) -> Path:
    return shared / "recordings/phobos_5mps.csv.gz"


@pytest.fixture
def lines(recording: Path, tmp_path: Path) -> list[str]:
    """The header and the first rows of the recording."""
    with gzip.open(recording, "rt") as file:
        return [next(file).rstrip("\n") for _ in range(50)]


@pytest.fixture
def written(tmp_path: Path, lines: list[str]):
    """Writes the first rows, changed, to a file that is named."""

    def write(name: str, change=lambda lines: lines) -> str:
        (tmp_path / name).write_text("\n".join(change(lines)) + "\n")
        return name

    return write


def test_a_real_rig_within_one_bit_of_its_converter(cli, recording: Path):
    figures = cli("replay", recording, *RIG, "--bicycle", "benchmark", "--json").json
    assert set(figures) >= KEYS
    assert figures["rows"] == 33_182
    assert 31_800 < figures["compared_rows"] < 32_000
    assert figures["max_torque_error_N_m"] <= 0.0053
    assert figures["rms_torque_error_N_m"] < figures["max_torque_error_N_m"]
    assert figures["max_one_step_roll_error_rad"] < 1.5e-7


def test_the_benchmark_is_taken_for_a_csv(cli, recording: Path):
    named = cli("replay", recording, *RIG, "--bicycle", "benchmark", "--json").json
    assert cli("replay", recording, *RIG, "--json").json == named


@pytest.mark.parametrize(
    "wrong", [(), ("--gravity", 9.80665), (*RIG, "--bicycle", "rigid"), (*RIG, "--law", "off")]
)
def test_anything_else_than_that_rig_does_not_fit(cli, recording: Path, wrong):
    figures = cli("replay", recording, *wrong, "--json").json
    assert figures["max_torque_error_N_m"] > 0.01


@pytest.mark.parametrize("law", ["paper", "momentum", "off"])
def test_a_record_of_ours_gives_its_torques_again(cli, law: str):
    ride = ("--law", law, "--rig", "delft2013", "--push", "0.1:3", "--seed", 3)
    profile = ("--set", "speed_profile=[[0, 3.2], [0.6, 4]]", "--gravity", 9.8, "--duration", 0.8)
    assert cli("run", "--output", "run.h5", *ride, *profile).status == 0
    figures = cli("replay", "run.h5", "--json").json
    assert figures["rows"] == figures["compared_rows"] == figures["ridden_again_rows"] == 800
    assert figures["max_torque_error_N_m"] == figures["max_ridden_again_torque_error_N_m"] == 0
    # The momentum law goes from the recorded rate to the momentum and back: one rounding.
    rounding = 1e-15 if law == "momentum" else 0
    assert figures["max_one_step_roll_error_rad"] <= rounding
    assert figures["max_one_step_roll_rate_error_rad_s"] <= rounding


def test_a_record_without_its_rig_file_is_ridden_again(cli, tmp_path: Path):
    (tmp_path / "mine.toml").write_text("inertia = 0.2\nsteer_stop_deg = 50\n")
    assert cli("run", "--rig", "mine.toml", "--duration", 0.3, "--output", "run.h5").status == 0
    (tmp_path / "mine.toml").unlink()
    assert cli("replay", "run.h5", "--json").json["max_ridden_again_torque_error_N_m"] == 0


def test_a_fall_is_left_out_of_the_comparison(cli):
    cli("run", "--law", "off", "--output", "run.h5")
    figures = cli("replay", "run.h5", "--json").json
    assert figures["compared_rows"] <= figures["rows"] == figures["ridden_again_rows"]


def test_another_law_than_the_recorded_one_differs(cli, record: Path):
    figures = cli("replay", record, "--law", "momentum", "--json").json
    assert figures["max_one_step_roll_rate_error_rad_s"] > 1e-6
    assert "ridden_again_rows" not in figures


def test_for_people(cli, record: Path):
    said = cli("replay", record)
    assert said.status == 0
    assert "benchmark, law paper, g 9.81 m/s²" in said.out
    assert "max torque error [N m]: 0\n" in said.out


@pytest.mark.parametrize("name", ["r.csv", "r.CSV"])
def test_a_csv_that_is_not_packed(cli, written, name: str):
    assert cli("replay", written(name), *RIG, "--json").json["rows"] == 49


def test_columns_in_any_order_with_others_between(cli, written):
    def turned(lines: list[str]) -> list[str]:
        return [",".join(reversed(line.split(","))) for line in lines]

    expected = cli("replay", written("r.csv"), *RIG, "--json").json
    assert cli("replay", written("r.csv", turned), *RIG, "--json").json == expected


def cell(line: int, column: int, text: str):
    """Changes one cell, lines counted from 1 as an editor does."""

    def change(lines: list[str]) -> list[str]:
        cells = lines[line - 1].split(",")
        cells[column] = text
        return [*lines[: line - 1], ",".join(cells), *lines[line:]]

    return change


CHANGES = {
    "without a column": (
        lambda lines: [line.rpartition(",")[0] for line in lines],
        "column speed_m_s is missing; a recording needs time_s, speed_m_s, roll_rad",
    ),
    "text": (cell(5, 3, "left"), "line 5: steer_rad = 'left' is not a number"),
    "nothing": (cell(5, 3, ""), "line 5: steer_rad = '' is not a number"),
    "nan": (cell(5, 3, "nan"), "line 5: steer_rad = nan is not finite"),
    "speed": (cell(5, -1, "1e200"), "line 5: speed_m_s = 1e200: must be from 0 to 100"),
    "angle": (cell(5, 3, "-101"), "line 5: steer_rad = -101: must be from -100 to 100"),
    "cut row": (lambda lines: [*lines[:9], lines[9][:20]], "line 10: has no"),
    "blank row": (lambda lines: [*lines[:9], "", *lines[9:]], "line 10: has no time_s"),
    "time back": (cell(5, 0, "9"), "line 6: time_s = 0.004 does not rise from 9.0"),
    "time still": (cell(5, 0, "0.002"), "line 5: time_s = 0.002 does not rise from 0.002"),
    "a gap": (cell(50, 0, "1e9"), "line 50: time_s = 1000000000.0 is more than 10 s after"),
    "no rows": (lambda lines: lines[:1], "has a header but no rows"),
    "one row": (lambda lines: lines[:2], "rows before the fall: 1; at least 2 are needed"),
    "empty": (lambda lines: [], "a recording"),
}


@pytest.mark.parametrize(("change", "message"), CHANGES.values(), ids=list(CHANGES))
def test_a_csv_that_cannot_be(refusal, written, change, message: str):
    said = refusal("replay", written("r.csv", change))
    assert "r.csv: " in said
    assert message in said


def test_an_empty_file(refusal, tmp_path: Path):
    (tmp_path / "r.csv").touch()
    assert "r.csv: is empty; a recording is a CSV with a header" in refusal("replay", "r.csv")


def test_a_binary_file_is_no_csv(refusal, tmp_path: Path):
    (tmp_path / "r.csv").write_bytes(bytes(range(255, 0, -1)))
    assert "r.csv: is not a CSV text file" in refusal("replay", "r.csv")


def test_a_packed_file_cut_short(refusal, recording: Path, tmp_path: Path):
    (tmp_path / "r.csv.gz").write_bytes(recording.read_bytes()[:5000])
    assert "r.csv.gz: cannot be read: compressed file ended" in refusal("replay", "r.csv.gz")


def test_a_packed_file_that_is_damaged(refusal, recording: Path, tmp_path: Path):
    whole = bytearray(recording.read_bytes())
    whole[5000:5100] = bytes(100)
    (tmp_path / "r.csv.gz").write_bytes(whole)
    assert "r.csv.gz: " in refusal("replay", "r.csv.gz")


def test_a_file_that_is_not_packed(refusal, written):
    assert "r.csv.gz: cannot be read: not a gzipped file" in refusal("replay", written("r.csv.gz"))


@pytest.mark.parametrize("name", ["pipe", "pipe.csv", "pipe.csv.gz"])
def test_a_pipe(refusal, tmp_path: Path, name: str):
    os.mkfifo(tmp_path / name)
    assert f"{name}: is not a plain file" in refusal("replay", name)


def test_a_byte_order_mark_is_no_error(cli, written, tmp_path: Path):
    path = tmp_path / written("r.csv")
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert cli("replay", "r.csv", "--json").status == 0


def test_a_folder(refusal, tmp_path: Path):
    (tmp_path / "r.csv").mkdir()
    assert "r.csv: cannot be read: is a directory" in refusal("replay", "r.csv")


@pytest.mark.parametrize("name", ["nix.csv", "nix.h5", "nix"])
def test_a_file_that_is_missing(refusal, name: str):
    assert f"{name}: " in refusal("replay", name)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--torque-limit", 0], "--torque-limit 0.0: must be above 0 N m"),
        (["--torque-limit", "nan"], "--torque-limit nan: must be above 0 N m"),
        (["--law", "pap"], "--law pap: must be one of paper, momentum, off"),
        (["--bicycle", "bench"], "unknown bicycle 'bench'; did you mean benchmark?"),
        (["--gravity", "nan"], "gravity = nan"),
        (["more"], "unexpected argument more"),
    ],
    ids=str,
)
def test_an_option_that_cannot_be(refusal, written, arguments: list, message: str):
    assert message in refusal("replay", written("r.csv"), *arguments)


def test_without_a_file(refusal):
    assert refusal("replay") == "bikesim: RECORDING is missing (bikesim replay --help)\n"
