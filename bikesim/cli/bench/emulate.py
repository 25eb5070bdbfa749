"""bikesim bench emulate"""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from bikesim.cli.bench.options import BenchName, arg
from bikesim.cli.overrides import scenario_from
from bikesim.cli.run import Run as VirtualRun


@dataclass(frozen=True)
class Emulate:
    """Be the bench of a profile: sensor node, drive, bar, and a virtual rider's hands on it.

    Runs in real time on the profile's bus until Ctrl-C, ride after ride. The rider lays his hands
    on the bar when a ride begins in this computer, and sees the bicycle as a display does.
    """

    bench: BenchName
    scenario: Annotated[Path | None, arg("FILE.toml", "A scenario file; of it the rider.")] = None
    rider: Annotated[str | None, arg("NAME", "Whose hands (default: human).")] = None
    speed: Annotated[
        float | None, arg("M/S", "That a speed sensor shows, and he is used to (default: 3.5).")
    ] = None
    seed: Annotated[int | None, arg("INT", "Of his noise (default: 1).")] = None
    set: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]],
        arg("KEY=VALUE", "Any other key of a scenario, such as rider.visual_delay=0.3."),
    ] = ()
    mishaps: Annotated[
        Path | None, arg("FILE.toml", "What goes wrong, and when: see docs/bench.md.")
    ] = None
    channel: Annotated[
        str | None,
        arg("CHANNEL", "The bench's end of the bus (slcan: its own tty), where not as the host's."),
    ] = None
    duration: Annotated[float | None, arg("S", "For so long (default: until Ctrl-C).")] = None

    def __call__(self) -> int:
        from bikesim.bench.emulator import Emulator, emulated_bus
        from bikesim.bench.mishaps import read_mishaps
        from bikesim.bench.profile import load_bench
        from bikesim.bench.scenario import bench_scenario
        from bikesim.experiment.watch import Watch

        bench = load_bench(self.bench)
        mishaps = () if self.mishaps is None else read_mishaps(self.mishaps)
        virtual = VirtualRun(
            scenario=self.scenario,
            rider=self.rider,
            speed=self.speed,
            seed=self.seed,
            set=self.set,
        )
        scenario = bench_scenario(bench, scenario_from(virtual))
        watch = Watch(1, 1.0, show=False)
        end_of_bus = bench.bus
        if self.channel is not None:
            end_of_bus = end_of_bus.model_copy(update={"channel": self.channel})
        with emulated_bus(end_of_bus) as bus, watch.watching():
            emulator = Emulator(bus, bench, scenario, mishaps)
            print(f"{bench.description or self.bench}", flush=True)
            print(f"on {end_of_bus}, rider {scenario.rider.name}; Ctrl-C ends it", flush=True)
            over = _Over(self.duration)
            emulator.run_prompt(lambda: watch() or over())
        print(
            f"largest torque {emulator.plant.largest_torque:.3f} N m; "
            f"at most {1e3 * emulator.longest:.1f} ms behind the time",
            flush=True,
        )
        return 0


class _Over:
    """Whether so many seconds are over since it was asked first."""

    def __init__(self, seconds: float | None) -> None:
        self._seconds = seconds
        self._began: float | None = None

    def __call__(self) -> bool:
        now = time.monotonic()
        self._began = now if self._began is None else self._began
        return self._seconds is not None and now - self._began > self._seconds
