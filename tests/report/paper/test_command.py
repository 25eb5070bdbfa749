"""bikesim paper, whole, on smaller maps and shorter rides."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from bikesim.cli.main import main
from bikesim.report.paper.command import Effort, run_paper

SMALLER = Effort(
    ride=10.0,
    identified_ride=5.0,
    delays=(0.0, 0.1, 0.2, 0.3, 0.4),
    stiffnesses=(0.0, 5.0, 10.0, 20.0, 30.0),
    dampings=(0.0, 2.0, 4.0, 6.0),
    check_ride=20.0,
    check_every=(2, 2),
)

DO_NOT_HOLD = {
    "Table 1: eigenvectors of M, as printed",
    "Figure 2: striking similarity to the bicycle, castering [1/s]",
    "Haptics off, nobody stabilises 3.5 m/s",
}


@pytest.mark.slow
def test_the_paper_is_reproduced(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    folder = tmp_path / "paper"
    assert run_paper(folder, force=False, as_json=True, effort=SMALLER) == 0
    printed: list[dict[str, Any]] = json.loads(capsys.readouterr().out)

    assert {entry["claim"] for entry in printed if not entry["holds"]} == DO_NOT_HOLD
    assert all(list(entry) == ["claim", "paper", "ours", "holds", "note"] for entry in printed)
    assert all(entry["note"] for entry in printed if not entry["holds"])
    assert json.loads((folder / "paper.json").read_text("utf-8")) == printed

    for name in ("figure2", "figure5", "identified-riders", "stability-map"):
        assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert (folder / f"{name}.pdf").read_bytes().startswith(b"%PDF")
    assert len(list((folder / "records").glob("*.h5"))) == 3 + 30
    with (folder / "stability-map.csv").open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 2 * (5 * 5 + 4 * 5)


def test_a_folder_that_is_there_ends_with_status_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    assert main(["paper", "--output", str(tmp_path)]) == 2
    assert "--force" in capsys.readouterr().err
