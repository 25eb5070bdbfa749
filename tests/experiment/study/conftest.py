from collections.abc import Callable
from pathlib import Path

import pytest

from bikesim.experiment.study.plan import Study, make_study
from bikesim.experiment.study.reading import parse_experiment

# Haptics on and off, two delays; short, and long enough for a fall with haptics off.
SMALL = """
title = "Small"
seeds = 3
[scenario]
duration = 0.2
[factors]
law = ["paper", "off"]
"rider.visual_delay" = [0.1, 0.2]
"""


@pytest.fixture
def make(tmp_path: Path) -> Callable[[str], Study]:
    """The study of an experiment's text, whose files lie in the test's own folder."""
    return lambda text: make_study(parse_experiment(text, tmp_path))


@pytest.fixture
def shadowed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, in which modules have the names of others' and cannot be imported."""
    folder = tmp_path / "shadowed"
    folder.mkdir()
    for name in ("bikesim", "signal", "queue", "json"):
        (folder / f"{name}.py").write_text("raise SystemExit('of the current folder')\n")
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def small(make: Callable[[str], Study]) -> Study:
    """Four conditions, three seeds, 0.2 s each."""
    return make(SMALL)
