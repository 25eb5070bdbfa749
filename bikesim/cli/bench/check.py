"""bikesim bench check"""

import sys
from dataclasses import dataclass

from bikesim.cli.bench.options import BenchName
from bikesim.cli.output import print_json, print_table
from bikesim.cli.parsing import Flag


@dataclass(frozen=True)
class Check:
    """Who answers on the bus, and how well: a table, green or red. Exit status 1 when red.

    Sends nothing until it has listened; then sets the drive up, proves its watchdog (enabled at
    zero torque) and leaves it disabled. With --pulse also proves signs, units and inertia.
    """

    bench: BenchName
    pulse: Flag = False
    """The commissioning pulse too (at most 0.3 N m, hands off the bar!); a profile that is a file
    of yours then remembers that this bar and drive passed it."""
    json: Flag = False
    """Print JSON."""

    def __call__(self) -> int:
        from bikesim.bench.check import check, remember
        from bikesim.bench.profile import load_bench

        bench = load_bench(self.bench)
        found = check(bench, pulse=self.pulse)
        passed = all(one.good for one in found)
        remembered = remember(self.bench, bench) if self.pulse and passed else None
        if self.json:
            print_json(
                {
                    "bench": self.bench,
                    "good": passed,
                    "commissioned": remembered,
                    "checks": [one._asdict() for one in found],
                }
            )
        else:
            rows = [[_light(one.good), one.what, one.found, one.wanted] for one in found]
            print_table(["", "what", "found", "should be"], rows, left=4)
            if remembered:
                print(remembered)
        return 0 if passed else 1


def _light(good: bool) -> str:
    word = "green" if good else "RED"
    if not sys.stdout.isatty():
        return word
    return f"\x1b[{32 if good else 31}m{word}\x1b[0m"
