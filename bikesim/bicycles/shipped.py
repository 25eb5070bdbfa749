"""The bicycles that ship with bikesim: one TOML file each in `data/`, with its source."""

from importlib.resources import files


def names() -> tuple[str, ...]:
    """The names of the shipped bicycles, in alphabetical order."""
    listing = (entry.name for entry in (files("bikesim.bicycles") / "data").iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in listing if name.endswith(".toml")))


def shipped_text(name: str) -> str:
    """The TOML text of the shipped bicycle `name`, one of `names()`."""
    return (files("bikesim.bicycles") / "data" / f"{name}.toml").read_text(encoding="utf-8")
