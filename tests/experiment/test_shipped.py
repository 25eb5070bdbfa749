"""The experiments that ship: sound, and each with a page that says what was found."""

from pathlib import Path

import pytest

from bikesim.experiment.study.plan import make_study
from bikesim.experiment.study.reading import read_experiment, shipped_names

NAMES = shipped_names()


def test_the_four_of_the_documentation_are_there():
    assert set(NAMES) >= {"haptics-cues-speed", "delay-arms", "loop-lag", "torque-limit"}


@pytest.mark.parametrize("name", NAMES)
def test_it_is_sound_and_says_what_it_asks(name: str):
    study = make_study(read_experiment(name))
    assert study.experiment.title
    assert "?" in study.experiment.description
    assert len(study.conditions) > 1


@pytest.mark.parametrize("name", NAMES)
def test_its_page_is_of_this_experiment(name: str, repository: Path):
    study = make_study(read_experiment(name))
    page = (repository / "docs" / "experiments" / f"{name}.md").read_text("utf-8")
    seeds = len(study.experiment.seeds)
    assert f"    bikesim experiment {name}\n" in page
    assert f"{len(study.conditions)} conditions of {seeds} seeds" in page
    assert f": {study.runs} runs" in page
