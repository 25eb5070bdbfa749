"""bikesim info"""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from bikesim.cli.output import print_json, print_table
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError

if TYPE_CHECKING:
    from bikesim.record.reader import Run


@dataclass(frozen=True)
class Info:
    """What a record holds; or, without one, the bicycles, riders, rigs and keys that there are."""

    record: Annotated[
        Path | None,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="[RUN.h5]", help="A run file.", help_behavior_hint=""),
    ] = None
    scenario: Flag = False
    """Print only its resolved scenario: a TOML file that runs it again."""
    keys: Flag = False
    """List every key of a scenario with its default and meaning."""
    bicycle: Annotated[
        str | None,
        tyro.conf.arg(
            metavar="NAME|FILE",
            help="Print a bicycle by name or file as our TOML.",
            help_behavior_hint="",
        ),
    ] = None
    json: Flag = False
    """Print JSON."""

    def __call__(self) -> int:
        asked = (self.record is not None, self.keys, self.bicycle is not None)
        if sum(asked) > 1:
            raise InputError("info: takes a record, --keys or --bicycle, one of them at a time")
        if self.record is not None:
            return self._of_record(self.record)
        if self.scenario:
            raise InputError("info --scenario: a record is missing")
        if self.bicycle is not None:
            self._show_bicycle(self.bicycle)
        elif self.keys:
            self._list_keys()
        else:
            self._list_names()
        return 0

    def _of_record(self, path: Path) -> int:
        from bikesim.record.reader import open_run

        run = open_run(path)
        if self.scenario:
            print(run.scenario, end="")
        elif self.json:
            print_json(described(run))
        else:
            _tell(run)
        return 0

    def _show_bicycle(self, name: str) -> None:
        from bikesim import bicycles

        text = bicycles.to_toml(bicycles.load(name))
        if self.json:
            print_json(tomllib.loads(text))
        else:
            print(text, end="")

    def _list_names(self) -> None:
        from bikesim import bicycles
        from bikesim.rider.kinds import rider_names
        from bikesim.rig.settings import rig_names

        names = {"bicycles": bicycles.names(), "riders": rider_names(), "rigs": rig_names()}
        if self.json:
            print_json(names)
            return
        for kind, known in names.items():
            print(f"{kind}: {', '.join(known)}")
        print("bikesim info RECORD describes a run; bikesim info --keys lists a scenario's keys.")

    def _list_keys(self) -> None:
        from bikesim.experiment.keys import scenario_keys

        rows = scenario_keys()
        if self.json:
            print_json([row._asdict() for row in rows])
            return
        width = max(len(row.key) for row in rows)
        for row in rows:
            default = f" Default: {row.default}." if row.default else ""
            print(f"{row.key.ljust(width)}  {row.meaning}{default}")


def described(run: "Run") -> dict[str, Any]:
    """A record as `bikesim info --json` gives it."""
    ending = run.ending
    return {
        "record": str(run.path),
        "complete": run.complete,
        "reason": None if ending is None else ending.reason,
        "fell": None if ending is None else ending.fell,
        "fall_time_s": None if ending is None else ending.fall_time,
        "ticks": run.ticks,
        "period_s": run.period,
        "last_time_s": float(run.time[-1]) if run.ticks else None,
        "bicycle": run.bicycle.name,
        "bicycle_source": run.bicycle.source,
        "law": run.law,
        "handlebar_inertia_kg_m2": run.handlebar_inertia,
        "rider": run.rider,
        "rig": run.rig,
        "seed": run.seed,
        "created": run.created,
        "commit": run.commit,
        "versions": dict(run.versions),
        "digest": run.digest(),
        "compute_time_s": _percentiles(run),
        "channels": [
            {"name": c.name, "unit": c.unit, "sign": c.sign, "description": c.description}
            for c in run.channels
        ],
    }


def _percentiles(run: "Run") -> dict[str, float]:
    import numpy as np

    if not run.ticks:
        return {}
    median, high, most = np.percentile(run.timing("compute_time"), [50, 99, 100]).tolist()
    return {"median": median, "p99": high, "max": most}


def _tell(run: "Run") -> None:
    about = described(run)
    ended = about["reason"] if run.complete else "not closed: killed, or still running"
    print(f"{run.path}: {run.ticks} ticks of {run.period:g} s; {ended}")
    for key in ("bicycle", "law", "rider", "rig", "seed", "handlebar_inertia_kg_m2", "created"):
        print(f"  {key.replace('_kg_m2', ' [kg m²]').replace('_', ' ')}: {about[key]}")
    print(f"  commit: {run.commit or 'not from a source tree'}")
    print(f"  versions: {', '.join(f'{name} {version}' for name, version in run.versions)}")
    times = ", ".join(f"{name} {value * 1e6:.0f}" for name, value in _percentiles(run).items())
    print(f"  compute time of a tick [µs]: {times or 'none measured'}")
    print(f"  digest: {about['digest']}\n")
    print_table(
        ["channel", "unit", "sign", "description"],
        [[c.name, c.unit, c.sign, c.description] for c in (*run.channels, *run.timing_channels)],
        left=4,
    )
