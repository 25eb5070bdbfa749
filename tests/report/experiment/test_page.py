import dataclasses
import json
import math
import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pandas as pd
import pytest

from bikesim.cli.main import main
from bikesim.errors import InputError
from bikesim.report.experiment.data import Condition, Data
from bikesim.report.experiment.findings import find
from bikesim.report.experiment.page import draw, page, write_report
from bikesim.report.experiment.told_json import told_json


class Page(HTMLParser):
    """What a page is made of: its elements, their identifiers, where its links lead, its text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.ids: list[str] = []
        self.links: list[str] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            if name in ("href", "src", "xlink:href"):
                self.links.append(value or "")

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.fixture(scope="module")
def text(data: Data) -> str:
    findings = find(data)
    return page(data, findings, tuple(draw(data, findings)))


def test_it_needs_nothing_from_elsewhere(text: str):
    made = Page(text)
    assert {"script", "link", "img", "iframe"}.isdisjoint(made.tags)
    assert not [link for link in made.links if "://" in link or link.startswith("//")]
    assert not re.search(r"url\((?!#)", text)
    assert "@import" not in text


def test_figures_are_in_it_and_their_names_do_not_clash(text: str):
    made = Page(text)
    assert made.tags.count("svg") == 7  # falls, survival, three metrics, contrasts, odds
    assert len(made.ids) == len(set(made.ids))
    within = {link[1:] for link in made.links if link.startswith("#")}
    assert within <= set(made.ids)
    assert set(re.findall(r"url\(#([^)]*)\)", text)) <= set(made.ids)


def test_what_a_user_wrote_is_text(text: str):
    assert "<h1>Made up &amp; &lt;tested&gt;</h1>" in text


def test_it_says_what_was_asked_and_found(text: str):
    told = " ".join(Page(text).text.split())
    for words in (
        "What does it say?",
        "12 conditions 12 seeds each 144 runs 24 fell (16.7 %)",
        "law off against paper, where roll cue on, speed 2.5 m/s",
        "The factors separate falls from the rest",
        "bikesim1.2.3",
        "Standard deviation of lateral position",
        'title = "Made up"',
    ):
        assert words in told, words


def test_a_metric_that_nothing_can_be_compared_in_has_no_empty_table(data: Data):
    lacking = dataclasses.replace(data, metrics=("roll_rms", "handling_quality"))
    findings = find(lacking)
    told = Page(page(lacking, findings, tuple(draw(lacking, findings)))).text
    assert told.count("No contrast has 6 pairs") == 1
    assert told.count("mean difference") == 1


def test_the_fall_time_is_not_told_twice_nor_of_the_fallen_alone(text: str):
    table = text[text.index('id="conditions"') : text.index('id="falls"')]
    assert "fall time" not in table
    assert table.count("not reached") == 10
    assert "Median by Kaplan-Meier of all runs" in text


def test_a_regression_that_did_not_converge_is_told(data: Data, text: str):
    findings = find(data)
    model = findings.regression.model
    assert model is not None
    assert "did not converge" not in text
    off = findings.regression._replace(model=model._replace(converged=False))
    made = page(data, findings._replace(regression=off), tuple(draw(data, findings)))
    assert "The fit did not converge" in made


def test_slopes_alone_are_against_no_level(data: Data, text: str):
    assert "Against: law paper, roll cue on, speed 2.5 m/s." in text
    findings = find(data)
    none = findings._replace(regression=findings.regression._replace(reference=()))
    assert "Against:" not in page(data, none, tuple(draw(data, findings)))


def test_contrasts_that_no_figure_has_are_in_the_table(data: Data):
    findings = find(data)
    many = findings._replace(contrasts=6 * findings.contrasts)
    made = page(data, many, tuple(draw(data, many)))
    assert "The first 100; the other 20 are in the table alone." in made
    table = made[made.index("<h3>Falls</h3>") :]
    assert table[: table.index("</table>")].count('<td class="what">') == 120


def test_a_condition_beside_the_grid_is_called_by_its_name(data: Data):
    """Also one that has a level of every factor, as a cell of the grid has."""
    cell = data.conditions[0]
    rows = data.table[data.table["condition"] == cell.name].assign(condition="a hard start")
    more = dataclasses.replace(
        data,
        conditions=(*data.conditions, Condition("a hard start", cell.levels, beside=True)),
        table=pd.concat([data.table, rows]),
    )
    findings = find(more)
    made = page(more, findings, tuple(draw(more, findings)))
    table = made[made.index('id="conditions"') : made.index('id="falls"')]
    assert table.count("a hard start") == 1
    assert cell.name not in table


def test_each_condition_is_a_row(text: str):
    table = text[text.index('id="conditions"') : text.index('id="falls"')]
    assert table.count("<tr>") == 1 + 12
    assert "100</span> <span>[75.8, 100]" in table  # Wilson, 12 of 12


def test_links_lead_to_the_kept_runs(text: str):
    assert "records/a%20b.h5" in Page(text).links
    assert "videos/a%20b.mp4" in Page(text).links


def test_the_statistics_for_programs_are_the_same(data: Data):
    findings = find(data)
    told = json.loads(told_json(data, findings))
    assert told["runs"] == 144
    assert told["units"]["roll_rms"] == "rad"
    condition = told["conditions"][6]
    assert condition["falls"]["events"] == 12
    assert condition["metrics"][1]["median"] is None
    contrast = told["contrasts"][6]
    assert contrast["comparison"]["name"] == data.comparisons[6].name
    expected = findings.contrasts[6].metrics[0].difference.mean
    assert contrast["metrics"][0]["difference"]["mean"] == expected
    assert told["tests"] == findings.tests
    assert not [value for value in _numbers(told) if not math.isfinite(value)]


def _numbers(value):
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [number for one in value for number in _numbers(one)]
    return [value] if isinstance(value, float) else []


EXPERIMENT = """
title = "Small"
seeds = [3, 5]
keep = "first"
keep_limit = 1

[scenario]
duration = 2.0
start = { roll_deg = 30 }

[factors.haptics.on]
law = "paper"

[factors.haptics.off]
law = "off"

[factors]
"rider.visual_delay" = [0.1, 0.2]

[report]
metrics = ["fall_time"]
contrasts = [
    { factor = "haptics", levels = ["on", "off"] },
    { of = "upright", against = "haptics=on, visual_delay=0.1" },
]

[[conditions]]
name = "upright"
set = { start = { roll_deg = 0 } }
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of a small experiment, with its report."""
    place = tmp_path_factory.mktemp("small")
    (place / "small.toml").write_text(EXPERIMENT, "utf-8")
    assert main(["experiment", str(place / "small.toml"), "-o", str(place / "results")]) == 0
    return place / "results"


def test_a_folder_of_results_gets_its_report(folder: Path):
    made = Page((folder / "report.html").read_text("utf-8"))
    told = " ".join(made.text.split())
    assert "5 conditions 2 seeds each 10 runs" in told
    assert "haptics off against on, where visual delay 0.1 s" in told
    assert "upright against haptics=on, visual_delay=0.1" in told
    programs = json.loads((folder / "statistics.json").read_text("utf-8"))
    assert [one["comparison"]["second"] for one in programs["contrasts"]][2:] == ["upright"]
    assert "visual delay against" not in told
    for link in made.links:
        assert link.startswith("#") or (folder / unquote(link)).exists(), link
    assert (folder / "statistics.json").is_file()


def test_figures_lie_beside_it_for_a_paper(folder: Path):
    names = {path.name for path in (folder / "figures").iterdir()}
    for name in ("falls", "survival", "fall_time", "contrasts"):
        assert {f"{name}.pdf", f"{name}.png"} <= names


def test_the_same_results_give_the_same_page(folder: Path):
    before = (folder / "report.html").read_bytes()
    write_report(folder)
    assert (folder / "report.html").read_bytes() == before


def test_a_folder_without_results(tmp_path: Path):
    with pytest.raises(InputError, match="is not a folder of an experiment's results"):
        write_report(tmp_path)


def test_what_cannot_be_written(folder: Path, tmp_path: Path):
    for name in ("manifest.json", "experiment.toml", "results.parquet"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    (tmp_path / "figures").touch()  # where the figures are to lie
    with pytest.raises(InputError, match=r"figures/falls\.pdf: cannot be written"):
        write_report(tmp_path)
