"""The report of an experiment: one HTML page, its figures, its statistics for programs."""

import io
import re
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

from matplotlib.figure import Figure

from bikesim.experiment.metric_table import BY_NAME, FALL_TIME, METRICS, OF_ALL_RUNS
from bikesim.record.output import put_in_place, unwritable
from bikesim.report.experiment import words
from bikesim.report.experiment.comparisons import MOST
from bikesim.report.experiment.data import Data, shown
from bikesim.report.experiment.figures import (
    MOST_ROWS,
    contrasts_figure,
    falls_figure,
    metric_figure,
    odds_figure,
)
from bikesim.report.experiment.findings import Findings, find
from bikesim.report.experiment.layout import arrange
from bikesim.report.experiment.pairs import FEWEST
from bikesim.report.experiment.reading import read_data
from bikesim.report.experiment.survival_figure import survival_figure, without_bands
from bikesim.report.experiment.told_json import told_json
from bikesim.report.style import save, styled

_FEW = 24  # conditions whose table may stand before the figures
PAGE, STATISTICS, FIGURES = "report.html", "statistics.json", "figures"


class Drawn(NamedTuple):
    """A figure with the name of its files and what stands under it."""

    name: str
    caption: str
    figure: Figure


def write_report(folder: Path) -> Path:
    """The page of a results folder, `figures/` and `statistics.json` beside it. Raises InputError.

    The page needs nothing else: figures are in it, and no address of another place.
    """
    data = read_data(folder)
    findings = find(data)
    drawn = tuple(draw(data, findings))
    for one in drawn:
        _settle(one.figure)
        for suffix in (".pdf", ".png"):
            save(one.figure, folder / FIGURES / f"{one.name}{suffix}")
    _write(folder / STATISTICS, told_json(data, findings))
    return _write(folder / PAGE, page(data, findings, drawn))


def draw(data: Data, findings: Findings) -> Iterator[Drawn]:
    """The figures of an experiment, in their order on the page."""
    layout = arrange(data.factors, data.conditions)
    yield Drawn(
        "falls",
        "Share of runs that fell, with 95 % Wilson intervals.",
        falls_figure(findings, layout),
    )
    if any(one.falls.events for one in findings.conditions):
        bands = "" if without_bands(layout) else " Bands: 95 %, by point."
        yield Drawn(
            "survival",
            "Share still up over time (Kaplan-Meier; runs that stayed up are censored)." + bands,
            survival_figure(findings, layout),
        )
    for name in data.metrics:
        told = f"{BY_NAME[name].definition} {_which_median(name)}"
        yield Drawn(name, told, metric_figure(findings, layout, name))
    if findings.contrasts:
        yield Drawn(
            "contrasts",
            "Differences in falls over the same seeds, with 95 % intervals; blue: p < 0.05 after "
            "Holm's correction." + _left_out(len(findings.contrasts)),
            contrasts_figure(findings.contrasts),
        )
    model = findings.regression.model
    if model is not None:
        yield Drawn(
            "odds",
            "Odds ratios of a fall by logistic regression, with 95 % profile likelihood "
            "intervals; blue: p < 0.05 after Holm's correction.",
            odds_figure(model.terms),
        )


def _left_out(contrasts: int) -> str:
    if contrasts <= MOST_ROWS:
        return ""
    return f" The first {MOST_ROWS}; the other {contrasts - MOST_ROWS} are in the table alone."


def _which_median(name: str) -> str:
    if name == FALL_TIME:
        return (
            "Median by Kaplan-Meier of all runs, those that stayed up censored, with its 95 % "
            "interval, drawn to the longest ride where it has no end; none where fewer than half "
            "fell."
        )
    which = "all runs" if name in OF_ALL_RUNS else "the runs that stayed up"
    return f"Median of {which}, with its 95 % interval; hollow: fewer than 6 runs, so none."


def page(data: Data, findings: Findings, drawn: tuple[Drawn, ...]) -> str:
    """The HTML text."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    for filter_ in (
        words.number,
        words.percent,
        words.p_value,
        words.plain,
        words.headed,
        words.unbroken,
    ):
        environment.filters[filter_.__name__] = filter_
    environment.filters["shown"] = shown
    environment.globals |= {
        "interval": words.interval,
        "odds": words.odds,
        "fall_time": words.fall_time,
        "FALL_TIME": FALL_TIME,
    }
    text = (files("bikesim.report.experiment") / "page.html").read_text("utf-8")
    falls = sum(one.falls.events for one in findings.conditions)
    return environment.from_string(text).render(
        data=data,
        findings=findings,
        figures={one.name: one for one in drawn},
        svg={one.name: svg(one) for one in drawn},
        metrics=[BY_NAME[name] for name in data.metrics],
        compared=[BY_NAME[name] for name in data.metrics if name not in OF_ALL_RUNS],
        all_metrics=METRICS,
        by_name=BY_NAME,
        beside=any(one.beside for one in data.conditions),
        of_all=words.listed(
            [
                words.plain(name)
                for name in data.metrics
                if name in OF_ALL_RUNS and name != FALL_TIME
            ]
        ),
        falls=falls,
        fewest=FEWEST,
        most=MOST,
        few=len(data.conditions) <= _FEW,
        faults=sum(one.faults for one in findings.conditions),
        runs=len(data.table),
        seeds=len(set(data.column("seed").tolist())),
    )


def svg(one: Drawn) -> str:
    """A figure as an element of the page; what it is called in it, it is called nowhere else."""
    buffer = io.StringIO()
    metadata: Any = {"Date": None, "Creator": None}
    with styled():
        one.figure.savefig(buffer, format="svg", metadata=metadata)
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r'(id="|href="#|url\(#)', rf"\g<1>{one.name}-", text)
    return text.replace("<svg ", f'<svg role="img" aria-label="{one.name}" ', 1)


def _settle(drawn: Figure) -> None:
    """Lay it out once, not again for each of its files: that takes longer than to draw it."""
    with styled():
        drawn.draw_without_rendering()
        drawn.set_layout_engine("none")


def _write(path: Path, text: str) -> Path:
    try:
        with put_in_place(path) as part:
            part.write_text(text, "utf-8")
    except OSError as error:
        raise unwritable(path, error) from error
    return path
