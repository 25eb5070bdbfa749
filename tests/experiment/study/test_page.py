"""docs/experiments.md says what there is."""

import re
from pathlib import Path

import pytest
from pydantic import BaseModel

from bikesim.experiment.study.plan import make_study
from bikesim.experiment.study.reading import parse_experiment, read_experiment, shipped_names
from bikesim.experiment.study.settings import (
    Contrast,
    Experiment,
    ExtraCondition,
    ReportSettings,
)

PAGE = (Path(__file__).parents[3] / "docs" / "experiments.md").read_text("utf-8")
TABLES: list[tuple[str, type[BaseModel]]] = [
    ("", Experiment),
    ("conditions.", ExtraCondition),
    ("report.", ReportSettings),
    ("report.contrasts.", Contrast),
]


@pytest.mark.parametrize(
    ("key", "field"),
    [
        pytest.param(f"{table}{name}", field, id=f"{table}{name}")
        for table, model in TABLES
        for name, field in model.model_fields.items()
        if name != "report"
    ],
)
def test_the_table_of_keys_has_each_with_its_default(key: str, field):
    row = next(line for line in PAGE.splitlines() if line.startswith(f"| `{key}` |"))
    meaning, default = (cell.strip() for cell in row.split("|")[2:4])
    assert meaning.startswith(field.description.rstrip("."))
    if field.is_required():
        assert default == "must be given"
    elif isinstance(field.default, tuple) and field.default:
        assert default == ", ".join(field.default)
    else:
        assert default == (str(field.default) if field.default not in ("", (), {}) else "none")


def test_the_example_is_an_experiment():
    block = re.search(r"(?m)^    # delays\.toml.*\n(?:(?:    .*)?\n)+", PAGE)
    assert block is not None
    study = make_study(parse_experiment(re.sub(r"(?m)^    ", "", block[0]), None))
    assert (len(study.conditions), study.runs) == (6, 600)


@pytest.mark.parametrize("name", shipped_names())
def test_an_experiment_that_ships_has_a_title_and_is_sound(name: str):
    experiment = read_experiment(name)
    assert experiment.title
    assert experiment.description
    assert make_study(experiment).runs > 1
