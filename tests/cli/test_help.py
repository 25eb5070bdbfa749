import dataclasses
import re

import pytest

from bikesim import __version__
from bikesim.cli.eig import Eig
from bikesim.cli.experiment import Experiment
from bikesim.cli.export import Export
from bikesim.cli.identify import Identify
from bikesim.cli.info import Info
from bikesim.cli.margins import Margins
from bikesim.cli.paper import Paper
from bikesim.cli.plot import Plot
from bikesim.cli.render import Render
from bikesim.cli.replay import Replay
from bikesim.cli.rider import Rider
from bikesim.cli.run import Run

COMMANDS = {
    "run": Run, "eig": Eig, "paper": Paper, "replay": Replay, "plot": Plot, "info": Info,
    "export": Export, "experiment": Experiment, "identify": Identify, "rider": Rider,
    "margins": Margins, "render": Render,
}  # fmt: skip

# What is known by its place, not by an option.
PLACES = ("scenario", "record", "records", "recording", "output", "file", "what", "name", "runs")


@pytest.mark.parametrize("arguments", [(), ("--help",), ("-h",)], ids=str)
def test_help_names_every_command_with_what_it_does(cli, arguments):
    said = cli(*arguments)
    assert (said.status, said.err) == (0, "")
    for name, command in COMMANDS.items():
        assert f"• {name} " in said.out
        assert (command.__doc__ or "").split()[0] in said.out


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_a_command_names_every_option_without_words_of_the_program(cli, name: str):
    said = cli(name, "--help")
    assert (said.status, said.err) == (0, "")
    for field in dataclasses.fields(COMMANDS[name]):
        if field.name not in PLACES:
            assert f"--{field.name.replace('_', '-')}" in said.out
    choices = re.compile(r"\{[a-z,]+\}")  # of words of the user's
    for word in ("None", "False", "True", "PATH", "STR", "{"):
        assert word not in choices.sub("", said.out)


def test_the_defaults_in_the_help_of_run_are_those_of_the_scenario(cli):
    text = " ".join(cli("run", "--help").out.replace("│", " ").split())
    for default in ("benchmark", "3.5", "paper", "human", "ideal", "30.0", "0.001", "0.0005"):
        assert f"(default: {default})" in text


def test_version(cli):
    assert cli("--version").out == f"bikesim {__version__}\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["rum"], "unknown command 'rum'; did you mean run?"),
        (["replya"], "unknown command 'replya'; did you mean replay?"),
        (["zzz"], "unknown command 'zzz'; known: run, experiment, identify, "),
        (["run.toml"], "unknown command 'run.toml'"),
        ([""], "unknown command ''"),
        (["--sped"], "unknown option --sped (bikesim --help)"),
    ],
    ids=str,
)
def test_what_is_no_command(refusal, arguments: list, message: str):
    assert message in refusal(*arguments)
