import numpy as np
import pytest

# [M07, Table 2]: speed, castering, capsize, weave.
PUBLISHED = [
    (1, -7.11008014637442, -3.13423125066578, 3.52696170990070 + 0.80774027519930j),
    (3, -10.35101467245920, -2.63366137253667, 1.70675605663975 + 2.31582447384325j),
    (5, -14.07838969279822, -0.32286642900409, -0.77534188219585 + 4.46486771378823j),
    (7, -18.15788466125262, 0.10268170574766, -2.13875644258362 + 7.19525913329805j),
    (10, -24.62459635017404, 0.16105338653172, -3.72016840437287 + 10.90681139476287j),
]


def eigenvalues(pairs: list[list[float]]) -> np.ndarray:
    return np.array([complex(*pair) for pair in pairs])


def test_json_has_the_keys_that_others_rely_on(cli):
    table = cli("eig", "--speeds", 5, "--json").json
    assert set(table) >= {
        "bicycle", "handlebar_inertia_kg_m2", "weave_speed_m_s", "capsize_speed_m_s", "rows",
    }  # fmt: skip
    assert set(table["handlebar_inertia_kg_m2"]) == {"paper", "momentum"}
    (row,) = table["rows"]
    assert set(row) == {"speed_m_s", "bicycle", "paper", "momentum"}
    for whose in ("bicycle", "paper", "momentum"):
        assert [len(pair) for pair in row[whose]] == [2, 2, 2, 2]


@pytest.mark.parametrize(("speed", "castering", "capsize", "weave"), PUBLISHED)
def test_published_eigenvalues_in_the_order_that_help_says(
    cli, speed: int, castering: float, capsize: float, weave: complex
):
    (row,) = cli("eig", "--speeds", speed, "--json").json["rows"]
    expected = [castering, capsize, weave, weave.conjugate()]
    assert eigenvalues(row["bicycle"]) == pytest.approx(expected, abs=1e-12)


def test_published_inertias_and_limits_of_the_benchmark(cli):
    table = cli("eig", "--json").json
    assert table["bicycle"] == "benchmark"
    assert table["handlebar_inertia_kg_m2"]["paper"] == pytest.approx(0.23108501173, abs=1e-11)
    assert table["handlebar_inertia_kg_m2"]["momentum"] == pytest.approx(0.2312758932, abs=1e-10)
    assert table["weave_speed_m_s"] == pytest.approx(4.29238253634111, abs=1e-11)
    assert table["capsize_speed_m_s"] == pytest.approx(6.02426201538837, abs=1e-11)


def test_the_momentum_law_has_the_eigenvalues_of_the_bicycle(cli):
    for row in cli("eig", "--speeds", "0.5:10:0.5", "--json").json["rows"]:
        assert eigenvalues(row["momentum"]) == pytest.approx(eigenvalues(row["bicycle"]), abs=1e-11)


def test_the_law_of_the_paper_at_its_speed(cli):
    """SCIENCE: eq. 7 at 3.5 m/s with I = λ2, to the digits given there."""
    (row,) = cli("eig", "--speeds", 3.5, "--json").json["rows"]
    expected = [-10.9161, -2.1632, 1.1367 + 2.6705j, 1.1367 - 2.6705j]
    assert eigenvalues(row["paper"]) == pytest.approx(expected, abs=6e-5)


def test_a_handlebar_of_another_inertia_moves_the_simulator_only(cli):
    (own,) = cli("eig", "--speeds", 5, "--json").json["rows"]
    (heavy,) = cli("eig", "--speeds", 5, "--inertia", 0.3, "--json").json["rows"]
    assert heavy["bicycle"] == own["bicycle"]
    assert heavy["paper"] != own["paper"]


@pytest.mark.parametrize(
    ("speeds", "expected"),
    [
        ("5", [5]),
        ("1,2.5,7", [1, 2.5, 7]),
        ("0:1:0.25", [0, 0.25, 0.5, 0.75, 1]),
        ("0:10:4", [0, 4, 8]),
        ("3:3:1", [3]),
        (" 1 , 2", [1, 2]),
    ],
)
def test_speeds_in_all_forms(cli, speeds: str, expected: list[float]):
    rows = cli("eig", "--speeds", speeds, "--json").json["rows"]
    assert [row["speed_m_s"] for row in rows] == expected


def test_a_fine_range_ends_where_it_was_told_to(cli):
    rows = cli("eig", "--speeds", "0:10:0.1", "--json").json["rows"]
    assert [row["speed_m_s"] for row in rows] == [i / 10 for i in range(101)]


def test_json_alone_draws_nothing(cli, tmp_path):
    cli("eig", "--json")
    assert list(tmp_path.iterdir()) == []


def test_a_table_and_a_figure_without_json(cli, tmp_path):
    said = cli("eig", "--speeds", 5)
    assert said.status == 0
    assert "-14.0784" in said.out
    assert "-0.7753 ± 4.4649i" in said.out
    assert "eigenvalues-benchmark.png" in said.out
    assert (tmp_path / "eigenvalues-benchmark.png").stat().st_size > 10_000


def test_the_figure_that_nobody_named_replaces_nothing(cli, tmp_path):
    (tmp_path / "eigenvalues-benchmark.png").write_text("precious")
    said = cli("eig", "--speeds", 5)
    assert said.status == 0
    assert "not drawn: eigenvalues-benchmark.png: is already there; --force replaces it" in said.out
    assert (tmp_path / "eigenvalues-benchmark.png").read_text() == "precious"


def test_a_second_figure_under_a_given_name_needs_force(cli, refusal):
    assert cli("eig", "--figure", "e.svg").status == 0
    assert "e.svg: is already there; --force" in refusal("eig", "--figure", "e.svg")
    assert cli("eig", "--figure", "e.svg", "--force").status == 0


@pytest.mark.parametrize("name", ["benchmark", "browser", "davis", "pista", "rigid"])
def test_each_shipped_bicycle(cli, name: str):
    table = cli("eig", "--bicycle", name, "--json").json
    assert table["bicycle"] == name
    assert 0 < table["weave_speed_m_s"] < table["capsize_speed_m_s"]


@pytest.mark.parametrize("file", ["BenchmarkBenchmark", "PistaPar", "RigidPar"])
def test_a_path_where_a_name_goes(cli, shared, file: str):
    path = shared / f"reference/bicycles/{file}.txt"
    assert cli("eig", "--bicycle", path, "--json").json["bicycle"] == file


def test_a_frame_and_a_rider_by_their_paths(cli, shared):
    folder = shared / "reference/bicycles"
    both = f"{folder}/BrowserBenchmark.txt+{folder}/JasonBrowserBenchmark.txt"
    alone = cli("eig", "--bicycle", folder / "BrowserBenchmark.txt", "--json").json
    ridden = cli("eig", "--bicycle", both, "--json").json
    assert ridden["bicycle"] == "BrowserBenchmark+JasonBrowserBenchmark"
    assert ridden["weave_speed_m_s"] != alone["weave_speed_m_s"]


def test_the_file_of_the_benchmark_is_the_benchmark(cli, shared):
    path = shared / "reference/bicycles/BenchmarkBenchmark.txt"
    assert cli("eig", "--bicycle", path, "--json").json["rows"] == cli("eig", "--json").json["rows"]


def test_our_toml_of_a_bicycle_is_read_back(cli, tmp_path):
    (tmp_path / "mine.toml").write_text(cli("info", "--bicycle", "pista").out)
    mine = cli("eig", "--bicycle", "mine.toml", "--json").json
    assert mine["rows"] == cli("eig", "--bicycle", "pista", "--json").json["rows"]


def test_gravity_of_another_place(cli):
    moon = cli("eig", "--gravity", 1.62, "--json").json
    assert moon["weave_speed_m_s"] < cli("eig", "--json").json["weave_speed_m_s"]


@pytest.mark.parametrize(
    "speeds",
    [
        "", "a", "1,", "1:2", "1:2:3:4", "0:10:0", "0:10:-1", "10:0:1", "nan", "inf", "-1", "101",
        "0:10:nan", "0:inf:1", "nan:1:1", "0:10:1e-9", "1;2", "0:200:10", "-1:1:1",
    ],
)  # fmt: skip
def test_speeds_that_cannot_be(refusal, speeds: str):
    message = refusal("eig", "--json", f"--speeds={speeds}")
    assert f"--speeds {speeds}: must be a speed (5)" in message
    assert "from 0 to 100 m/s" in message


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["--inertia", 0], ["--inertia 0.0", "above 0 and below 1000 kg m²"]),
        (["--inertia", "nan"], ["--inertia nan", "above 0"]),
        (["--inertia", "x"], ["--inertia x: must be a number"]),
        (["--gravity", -1], ["gravity = -1.0", "0 to 100 m/s²"]),
        (["--gravity", "nan"], ["gravity = nan"]),
        (["--gravity", "much"], ["--gravity much: must be a number"]),
        (["--bicycle", "benchmrk"], ["unknown bicycle 'benchmrk'", "did you mean benchmark?"]),
        (["--bicycle", "zzz"], ["unknown bicycle 'zzz'", "known: benchmark, browser, davis"]),
        (["--bicycle", "nix.txt"], ["nix.txt: no such bicycle file", "benchmark"]),
        (["--figure", "x.jpg"], ["x.jpg: cannot draw to '.jpg'", ".png, .pdf, .svg"]),
        (["--figure", "x"], ["x: cannot draw to ''", ".png"]),
        (["--figure", "/proc/x.png"], ["/proc/x.png: cannot be written"]),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused_before_anything_is_printed(refusal, arguments, parts):
    message = refusal("eig", *arguments)
    for part in parts:
        assert part in message
