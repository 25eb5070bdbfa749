"""What the documentation shows: its links, its commands, its tables."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from bikesim.cli import main
from bikesim.cli.bench.commands import parse_bench
from bikesim.cli.parsing import parse
from bikesim.experiment.keys import scenario_keys
from bikesim.record.channels import TICK_CHANNELS
from bikesim.rig.virtual import VIRTUAL_CHANNELS

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
COMMAND = re.compile(r"(?:    |\$ )+bikesim +(.*)")


def text_and_code(page: Path) -> tuple[list[str], list[str]]:
    """The lines of a page; those of code are the indented and the fenced, the first indented."""
    text, code, fenced = [], [], False
    for line in page.read_text(encoding="utf-8").splitlines():
        if line.startswith("```"):
            fenced = not fenced
        elif fenced:
            code.append(f"    {line}")
        else:
            (code if line.startswith("    ") else text).append(line)
    return text, code


def links(page: Path) -> list[str]:
    return LINK.findall("\n".join(text_and_code(page)[0]))


def commands(page: Path) -> list[str]:
    """What stands behind `bikesim` in lines of code, without where its output goes."""
    found = (COMMAND.match(line) for line in text_and_code(page)[1])
    return [re.split(r"\s[|>]\s", match[1])[0] for match in found if match]


def anchors(page: Path) -> set[str]:
    """The headings of a page as they are linked to."""
    headings = (line.lstrip("#") for line in text_and_code(page)[0] if line.startswith("#"))
    return {
        re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings
    }


def rows(page: str) -> list[list[str]]:
    """The rows of all tables of a page, cell by cell, whose first cell is code."""
    lines = (ROOT / "docs" / page).read_text(encoding="utf-8").splitlines()
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if line[:3] == "| `"]


def pairs(find: Callable[[Path], list[str]]) -> list[Any]:
    return [
        pytest.param(page, item, id=f"{page.name}: {item}") for page in PAGES for item in find(page)
    ]


@pytest.mark.parametrize(("page", "link"), pairs(links))
def test_a_link_leads_somewhere(page: Path, link: str):
    if "://" in link:
        return
    name, _, anchor = link.partition("#")
    target = (page.parent / name).resolve() if name else page
    assert target.is_relative_to(ROOT)
    assert target.exists()
    assert not anchor or anchor in anchors(target)


@pytest.mark.parametrize(("page", "command"), pairs(commands))
def test_a_command_that_is_shown_is_understood(page: Path, command: str):
    del page
    arguments = shlex.split(command, comments=True)
    if arguments[0] == "bench":
        assert parse_bench(arguments[1:]) is not None
    else:
        assert parse(main._COMMANDS, arguments, "") is not None


def test_commands_are_found():
    assert "run -o on.h5" in commands(ROOT / "docs" / "record.md")
    assert len(commands(ROOT / "README.md")) >= 5


def test_the_table_of_keys_has_each_key_and_its_default():
    shown = {row[0].strip("`"): row[2] for row in rows("scenario.md") if len(row) == 3}
    for key in scenario_keys():
        # A default that is not a value is said in words.
        assert shown.get(key.key, "").startswith(key.default), key
        assert shown[key.key], key


def test_the_table_of_channels_has_each_channel_as_it_is_recorded():
    channels = (*TICK_CHANNELS, *VIRTUAL_CHANNELS)
    assert rows("record.md") == [
        [f"`{channel.name}`", channel.unit, channel.sign, channel.description]
        for channel in channels
    ]
