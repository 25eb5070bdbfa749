"""What the commands of a bench take alike."""

from typing import Annotated, Any

import tyro


def arg(metavar: str, text: str, *aliases: str) -> Any:
    """An option's help."""
    return tyro.conf.arg(metavar=metavar, help=text, help_behavior_hint="", aliases=list(aliases))


BenchName = Annotated[
    str,
    tyro.conf.Positional,
    arg("BENCH", "A profile that ships, by its name, or a TOML file."),
]
Name = Annotated[str | None, arg("NAME", "By name or file (default: as for bikesim run).")]
