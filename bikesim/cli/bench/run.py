"""bikesim bench run"""

import sys
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from bikesim.cli.bench.options import BenchName, arg
from bikesim.cli.output import check_apart, check_output, print_json
from bikesim.cli.overrides import scenario_from
from bikesim.cli.parsing import Flag
from bikesim.cli.run import Run as VirtualRun
from bikesim.cli.run import dated
from bikesim.errors import InputError

if TYPE_CHECKING:
    from bikesim.bench.report import Timing
    from bikesim.record.reader import Run as Record

_MOST_ATTEMPTS = 100


@dataclass(frozen=True)
class Run:
    """Ride on a bench: arm, ramp in, ride, ramp out, disable; recorded as in the virtual rig.

    The keys of a scenario are those of bikesim run; rig and rider are the bench and who holds its
    bar. Ctrl-C ramps the torque out in 0.1 s; a second one ends it at once. Whatever ends the ride,
    the drive is disabled; what is not in this program's power (a cut cable, a killed process) the
    drive's own watchdog does, and the emergency stop is the hardware's.
    """

    bench: BenchName
    scenario: Annotated[Path | None, arg("FILE.toml", "A scenario file.")] = None
    bicycle: Annotated[str | None, arg("NAME|FILE", "A bicycle (default: benchmark).")] = None
    speed: Annotated[float | None, arg("M/S", "Without a speed sensor (default: 3.5).")] = None
    law: Annotated[
        str | None, arg("{paper,momentum,off}", "Of the feedback torque (default: paper).")
    ] = None
    path: Annotated[str | None, arg("KIND|FILE", "The prescribed path (default: straight).")] = None
    duration: Annotated[float | None, arg("S", "Of the ride [s] (default: 30).")] = None
    set: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]],
        arg("KEY=VALUE", "Any other key of a scenario, as for bikesim run."),
    ] = ()
    output: Annotated[
        Path | None, arg("FILE.h5", "The record (default: runs/ with date and time).", "-o")
    ] = None
    force: Flag = False
    """Replace a record that is there already."""
    no_frames: Flag = False
    """Do not keep the raw frames of the bus (else beside the record, .blf)."""
    attempts: Annotated[
        int,
        arg(
            "N",
            "After a fall the bicycle stands upright again, and whoever holds the bar may ride up "
            "to so many times in all, each with a record of its own (ride-2.h5…) (default: 1).",
        ),
    ] = 1
    pulse: Flag = False
    """A commissioning pulse first (at most 0.3 N m): hands off the bar until it is over."""
    uncommissioned: Flag = False
    """Ride though this bar and drive never passed the commissioning pulse."""
    without_margin: tyro.conf.UseCounterAction[int] = 0
    """Given twice: ride at a speed at which the loop has no margin."""
    report: Flag = False
    """Lateness and compute time of the ticks at the end: percentiles, a histogram, a figure."""
    display: Flag = False
    """Show the rider the road, in a window of a process of its own (bikesim bench display)."""
    json: Flag = False
    """Print the summary as JSON."""

    def __call__(self) -> int:
        from bikesim.bench.attempts import attempt_file, run_bench
        from bikesim.bench.display_process import DisplayProcess
        from bikesim.bench.profile import load_bench
        from bikesim.bench.ride import Order
        from bikesim.bench.scenario import bench_scenario
        from bikesim.record.reader import open_run

        bench = load_bench(self.bench)
        output = self.output or dated()
        frames = None if self.no_frames else output.with_suffix(".blf")
        if not 1 <= self.attempts <= _MOST_ATTEMPTS:
            raise InputError(f"--attempts {self.attempts}: must be 1 to {_MOST_ATTEMPTS}")
        for attempt in range(1, self.attempts + 1):
            self._check_files(attempt_file(output, attempt))
        order = Order(
            self.bench,
            bench,
            bench_scenario(bench, scenario_from(self._as_virtual())),
            self.pulse,
            self.uncommissioned,
            self.without_margin,
            frames,
        )
        say = _to_stderr if self.json else _told
        display = DisplayProcess(self.bench, say) if self.display else nullcontext()
        ridden: list[Path] = []
        try:
            # One by one: what was ridden is known, whatever becomes of a later one.
            ridden.extend(
                run_bench(
                    order,
                    output,
                    attempts=self.attempts,
                    force=self.force,
                    say=say,
                    display=display,
                )
            )
        except (InputError, KeyboardInterrupt):
            # A later attempt that could not be: of those before it is told all the same.
            if ridden:
                self._end([open_run(record) for record in ridden])
            raise
        return self._end([open_run(record) for record in ridden])

    def _as_virtual(self) -> VirtualRun:
        return VirtualRun(
            scenario=self.scenario,
            bicycle=self.bicycle,
            speed=self.speed,
            law=self.law,
            path=self.path,
            duration=self.duration,
            set=self.set,
        )

    def _check_files(self, output: Path) -> None:
        """What an attempt writes must not be there, nor what it reads."""
        frames = None if self.no_frames else output.with_suffix(".blf")
        picture = _picture_of(output) if self.report else None
        written = [path for path in (output, frames, picture) if path is not None]
        read = [Path(one) for one in (self.bench, self.bicycle, self.path) if one is not None]
        for path in written:
            others = (one for one in written if one is not path)
            check_apart(path, *filter(None, (self.scenario,)), *read, *others)
            check_output(path, force=self.force)

    def _end(self, records: "list[Record]") -> int:
        for record in records:
            if not record.ticks:
                raise InputError(f"{record.path}: the ride ended before its first tick")
        from bikesim.bench.report import timing_json, timing_report
        from bikesim.cli.telling import summary_json
        from bikesim.experiment.summary import summarise

        summaries = [summarise(record) for record in records]
        timings = [timing_report(record) for record in records]
        for record, summary, timing in zip(records, summaries, timings, strict=True):
            picture = self._draw(record, timing) if self.report else None
            if not self.json:
                self._tell(record, summary.reason, timing, picture)
        if self.json:
            said = [
                {**summary_json(summary), "timing": timing_json(timing)}
                for summary, timing in zip(summaries, timings, strict=True)
            ]
            print_json(said[0] if self.attempts == 1 else {"attempts": said})
        if (last := summaries[-1]).reason.startswith("fault"):
            raise InputError(f"{last.reason}; kept: {last.record}")
        return 0

    def _draw(self, record: "Record", timing: "Timing") -> Path:
        from bikesim.bench.report import timing_figure
        from bikesim.report.style import save

        picture = _picture_of(record.path)
        save(timing_figure(record, timing), picture)
        return picture

    def _tell(self, record: "Record", reason: str, timing: "Timing", picture: Path | None) -> None:
        from bikesim.bench.report import timing_told

        print(f"ended    {reason}, at {float(record.time[-1]):.2f} s")
        for line in timing_told(timing, histogram=self.report):
            print(line)
        print(f"record   {record.path}")
        if picture is not None:
            print(f"figure   {picture}")


def _picture_of(record: Path) -> Path:
    return record.with_name(f"{record.stem}-timing.png")


def _told(line: str) -> None:
    print(line, flush=True)


def _to_stderr(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
