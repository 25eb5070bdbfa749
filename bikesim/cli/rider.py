"""bikesim rider"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from bikesim.cli.output import print_json, print_table
from bikesim.cli.parsing import Flag
from bikesim.errors import InputError, unknown

if TYPE_CHECKING:
    from bikesim.rider.base import Setting


@dataclass(frozen=True)
class Rider:
    """The riders there are, with their figures; or try one, your own above all, on its contract.

    bikesim rider list, or bikesim rider check NAME|FILE.py:CLASS. A check takes a few seconds; its
    exit status is 1 if the rider does not do what every rider must.
    """

    what: Annotated[
        str,
        tyro.conf.Positional,
        tyro.conf.arg(metavar="{list,check}", help="List them, or check one."),
    ]
    name: Annotated[
        str | None,
        tyro.conf.Positional,
        tyro.conf.arg(
            metavar="[NAME|FILE.py:CLASS]",
            help="Of check: a rider by name, or a class in a file or an installed package.",
            help_behavior_hint="",
        ),
    ] = None
    bicycle: Annotated[str, tyro.conf.arg(metavar="NAME|FILE")] = "benchmark"
    """Of check: the bicycle that he is told of."""
    speed: Annotated[float, tyro.conf.arg(metavar="M/S")] = 5.0
    """Of check: the speed [m/s]."""
    json: Flag = False
    """Print JSON."""

    def __call__(self) -> int:
        if self.what not in ("list", "check"):
            raise unknown("action", self.what, ("list", "check"))
        if self.what == "list":
            if self.name is not None:
                raise InputError(f"rider list: unexpected argument {self.name}")
            return self._list()
        if self.name is None:
            raise InputError("rider check: a rider is missing, such as my_rider.py:MyRider")
        return self._check(self.name)

    def _list(self) -> int:
        from bikesim.rider.kinds import HUMAN_KEYS, described

        riders = described()
        if self.json:
            print_json([one._asdict() for one in riders])
            return 0
        rows = [[one.name, one.about, _figures_told(one.figures)] for one in riders]
        print_table(["rider", "", "figures"], rows, left=3)
        print(f"\nand of his body, of each but hands-off: {', '.join(HUMAN_KEYS)}")
        print("A rider of your own: FILE.py:CLASS. What each key means: bikesim info --keys.")
        return 0

    def _check(self, name: str) -> int:
        from bikesim.rider.contract import check
        from bikesim.rider.custom import load_class
        from bikesim.rider.settings import RiderSettings

        settings = RiderSettings(name=name)
        if settings.custom:
            load_class(name)  # a rider who is not there breaks no promise
        findings = check(settings, self._setting())
        passed = all(one.passed for one in findings)
        if self.json:
            rows = [one._asdict() for one in findings]
            print_json({"rider": name, "passed": passed, "findings": rows})
        else:
            rows = [["ok" if one.passed else "NO", one.what, one.detail] for one in findings]
            print_table(["", f"rider {name}", ""], rows, left=3)
        return 0 if passed else 1

    def _setting(self) -> "Setting":
        """A slalom, so that a rider who follows a path has one to follow."""
        from bikesim import bicycles
        from bikesim.model.law import Law
        from bikesim.model.simulator import handlebar_inertia
        from bikesim.path.building import make_path
        from bikesim.path.settings import PathSettings
        from bikesim.rider.base import Setting

        if not 0 < self.speed <= 30:
            raise InputError(f"--speed {self.speed}: must be above 0 and at most 30 m/s")
        bicycle, law = bicycles.load(self.bicycle), Law.PAPER
        return Setting(
            bicycle=bicycle,
            law=law,
            inertia=handlebar_inertia(bicycle, law),
            speed=self.speed,
            step=5e-4,
            path=make_path(PathSettings(kind="slalom", start=2.0)),
        )


def _figures_told(figures: dict[str, Any]) -> str:
    return ", ".join(
        f"{key} {value:g}" if isinstance(value, float) else key for key, value in figures.items()
    )
