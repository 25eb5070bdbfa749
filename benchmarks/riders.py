"""Who stays up: the identified riders and the default one, haptics on and off."""

from bikesim.experiment.run import build, ride_parts
from bikesim.experiment.scenario import LawName, Scenario, StartSettings
from bikesim.rider.schwab2013 import IDENTIFIED_RUNS
from bikesim.rider.settings import RiderSettings

_SEEDS = 100
_EXPECTED: tuple[tuple[LawName, str], ...] = (("paper", "15 stay up"), ("off", "15 fall"))
_FALLS: tuple[tuple[LawName, int], ...] = (("paper", 0), ("off", _SEEDS))


class _Nothing:
    def append(self, row: tuple[float, ...]) -> None:
        """The ending is all that is asked."""


def main() -> None:
    """Prints how many fell, with the target."""
    for law, target in _EXPECTED:
        fell = sum(_falls(_identified(run.run, run.speed, law)) for run in IDENTIFIED_RUNS)
        print(f"  15 identified riders, law {law}: {15 - fell} stay up, {fell} fall ({target})")
    for law, falls in _FALLS:
        fell = sum(_falls(Scenario(law=law, seed=seed)) for seed in range(_SEEDS))
        print(f"  default scenario, {_SEEDS} seeds, law {law}: {fell} falls (target: {falls})")


def _identified(number: int, speed: float, law: LawName) -> Scenario:
    return Scenario(
        bicycle="davis",
        speed=speed,
        law=law,
        rider=RiderSettings(name=f"schwab2013-{number}"),
        duration=20,
        start=StartSettings(roll_deg=1.0),
    )


def _falls(scenario: Scenario) -> bool:
    return ride_parts(build(scenario), _Nothing()).fell


if __name__ == "__main__":
    main()
