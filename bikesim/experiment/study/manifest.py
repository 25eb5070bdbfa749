"""What a folder of results says of the experiment whose results they are."""

import hashlib
import json
import tomllib
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple, Self

import bikesim
from bikesim.errors import InputError
from bikesim.experiment.metric_table import METRICS
from bikesim.experiment.study.named_files import Files, union
from bikesim.experiment.study.plan import Study
from bikesim.experiment.study.settings import Experiment
from bikesim.experiment.study.versions import Versions
from bikesim.record.output import put_in_place, unwritable
from bikesim.record.provenance import source_commit

MANIFEST, EXPERIMENT = "manifest.json", "experiment.toml"
_FORMAT = "bikesim experiment 1"
# What an experiment's results depend on; the rest of its file may change.
_DECISIVE = ("scenario", "factors", "conditions", "seeds", "folder")


class Manifest(NamedTuple):
    """Which conditions and seeds, computed with what; `runs` are planned.

    `digest` is of every figure of every condition, the seeds and the metrics. `files` has a digest
    of each file that scenarios name and of each that riders of the user's own are made of, and the
    version of each package that they come from.
    """

    digest: str
    runs: int
    files: Files
    versions: Versions
    commit: str | None
    created: str

    @classmethod
    def of(cls, study: Study) -> Self:
        """That of a study, now."""
        digest = hashlib.sha256()
        for condition in study.conditions:
            keys = condition.scenario.model_dump(mode="json", exclude={"seed"})
            told = [condition.name, condition.values, keys]
            digest.update(json.dumps(told, sort_keys=True).encode())
        metrics = [metric.name for metric in METRICS]
        told = [study.experiment.seeds, metrics]
        digest.update(json.dumps(told).encode())
        return cls(
            digest=digest.hexdigest(),
            runs=study.runs,
            files=union(study.files),
            versions=Versions.gather(),
            commit=source_commit(Path(bikesim.__file__).parents[1]),
            created=datetime.now(UTC).isoformat(timespec="seconds"),
        )

    @classmethod
    def read(cls, folder: Path) -> Self:
        """That of a folder of results. Raises InputError."""
        try:
            keys = json.loads((folder / MANIFEST).read_text("utf-8"))
            if keys.pop("format") != _FORMAT:
                raise ValueError
            return cls(**{**keys, "versions": Versions(**keys["versions"])})
        except FileNotFoundError:
            raise InputError(f"{folder}: is not a folder of an experiment's results") from None
        except (OSError, ValueError, TypeError, KeyError):
            raise InputError(f"{folder / MANIFEST}: is damaged, or of another bikesim") from None

    @property
    def software(self) -> str:
        """The versions, and the commit where there is one, for a message."""
        oid, plus, changed = (self.commit or "").partition("+")
        return f"{self.versions}" + (f", commit {oid[:12]}{plus}{changed}" if oid else "")

    def write(self, folder: Path) -> None:
        """Put it into a folder of results. Raises InputError."""
        told = {"format": _FORMAT, **self._asdict(), "versions": self.versions._asdict()}
        write_text(folder / MANIFEST, json.dumps(told, indent=2) + "\n")


def to_toml(experiment: Experiment) -> str:
    """An experiment as one file that runs it again; its base is part of it."""
    import tomli_w

    keys = experiment.model_dump(mode="json", exclude_defaults=True)
    if factors := keys.get("factors"):
        keys["factors"] = _in_order(factors)
    seeds = experiment.seeds
    counted = seeds == tuple(range(1, len(seeds) + 1))
    return tomli_w.dumps(
        {
            **{key: value for key, value in keys.items() if not isinstance(value, dict)},
            "seeds": len(seeds) if counted else list(seeds),
            **{key: value for key, value in keys.items() if isinstance(value, dict)},
        }
    )


def _in_order(factors: Mapping[str, Any]) -> dict[str, Any]:
    """Factors that TOML leaves in their order, which is that of the conditions.

    It has a table's lists before its tables: a list behind a table is made one.
    """
    ordered: dict[str, Any] = {}
    for name, given in factors.items():
        behind = any(isinstance(one, dict) for one in ordered.values())
        listed = behind and not isinstance(given, dict)
        ordered[name] = {"key": name, "values": given} if listed else given
    return ordered


def difference(before: str, after: str) -> str:
    """The first thing in which two experiments' files differ, of what results depend on."""
    try:
        was, is_ = tomllib.loads(before), tomllib.loads(after)
    except ValueError:
        return ""
    found = (_differing(was.get(key), is_.get(key), key) for key in _DECISIVE)
    return next((told for told in found if told), "")


def changed_file(before: Mapping[str, str], after: Mapping[str, str]) -> str:
    """A file or a version that both name, and that is another now."""
    return next((name for name in after if before.get(name, after[name]) != after[name]), "")


def write_text(path: Path, text: str) -> None:
    """A whole text file, or the one before it. Raises InputError."""
    try:
        with put_in_place(path) as part:
            part.write_text(text, "utf-8")
    except OSError as error:
        raise unwritable(path, error) from error


def _differing(was: Any, is_: Any, place: str) -> str:
    if was == is_:
        return ""
    if isinstance(was, dict) and isinstance(is_, dict):
        for key in [*was, *is_]:
            if told := _differing(was.get(key), is_.get(key), f"{place}.{key}"):
                return told
    return f"{place} was {_short(was)}, is {_short(is_)}"


def _short(value: Any) -> str:
    text = "not given" if value is None else json.dumps(value, default=str)
    return text if len(text) <= 60 else f"{text[:57]}..."
