"""bikesim run"""

import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from bikesim.cli.output import check_apart, check_output, print_json
from bikesim.cli.overrides import scenario_from
from bikesim.cli.parsing import Flag
from bikesim.cli.render import check_kind, render_run
from bikesim.errors import InputError
from bikesim.experiment.scenario import Scenario

_arg = tyro.conf.arg


def _described(name: str, metavar: str) -> Any:
    """The help of a scenario's key, and its default, from the scenario itself."""
    key = Scenario.model_fields[name]
    default = "" if key.default is None or key.is_required() else f" (default: {key.default})"
    return _arg(help=f"{key.description}{default}", help_behavior_hint="", metavar=metavar)


@dataclass(frozen=True)
class Run:
    """Ride a scenario in the virtual rig and record it.

    Without arguments: the benchmark bicycle at 3.5 m/s under the paper's law, with a human-like
    rider (visual delay 0.2 s, muscles, arms) for 30 s. The record is HDF5; see also bikesim plot,
    info and export.
    """

    scenario: Annotated[
        Path | None,
        tyro.conf.Positional,
        _arg(
            metavar="[SCENARIO.toml]",
            help="A scenario file; what is given beside it replaces its keys.",
            help_behavior_hint="",
        ),
    ] = None
    bicycle: Annotated[str | None, _described("bicycle", "NAME|FILE")] = None
    speed: Annotated[float | None, _described("speed", "M/S")] = None
    law: Annotated[str | None, _described("law", "{paper,momentum,off}")] = None
    path: Annotated[
        str | None,
        _arg(
            metavar="KIND|FILE",
            help="The prescribed path: straight, lane-change, double-lane-change, slalom, circle, "
            "figure-eight, or a CSV file of points; its figures are set with --set "
            "(default: straight).",
            help_behavior_hint="",
        ),
    ] = None
    rider: Annotated[
        str | None,
        _arg(
            metavar="NAME|FILE.py:CLASS",
            help="A rider by name, as bikesim rider list has them, or a class of your own; its "
            "figures are set with --set (default: human).",
            help_behavior_hint="",
        ),
    ] = None
    rig: Annotated[
        str | None,
        _arg(
            metavar="NAME|FILE",
            help="A rig by name, as bikesim info lists them, or a TOML file (default: ideal).",
            help_behavior_hint="",
        ),
    ] = None
    duration: Annotated[float | None, _described("duration", "S")] = None
    seed: Annotated[int | None, _described("seed", "INT")] = None
    gravity: Annotated[float | None, _described("gravity", "M/S²")] = None
    period: Annotated[float | None, _described("period", "S")] = None
    physics_step: Annotated[float | None, _described("physics_step", "S")] = None
    roll_deg: Annotated[
        float | None,
        _arg(metavar="DEG", help="Roll at the start [deg].", help_behavior_hint=""),
    ] = None
    push: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]],
        _arg(
            metavar="TIME:IMPULSE",
            help="A lateral push: time [s], impulse to the right [N s]; may be given again.",
            help_behavior_hint="",
        ),
    ] = ()
    set: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]],
        _arg(
            metavar="KEY=VALUE",
            help="Any other key of a scenario, as in its TOML: rider.visual_delay=0.3, "
            "rig.torque_limit=3.5, guard.fall_roll_deg=40. All keys: bikesim info --keys.",
            help_behavior_hint="",
        ),
    ] = ()
    output: Annotated[
        Path | None,
        _arg(
            aliases=["-o"],
            metavar="FILE.h5",
            help="The record (default: runs/ with date and time).",
            help_behavior_hint="",
        ),
    ] = None
    force: Flag = False
    """Replace a record that is there already."""
    figure: Flag = False
    """Also draw the run, as a PNG beside the record."""
    video: Annotated[
        tuple[Path, ...] | None,
        _arg(
            metavar="[FILE]",
            help="Also make a video of the run, .mp4, .webm or .gif (default: beside the record).",
            help_behavior_hint="",
        ),
    ] = None
    json: Flag = False
    """Print the summary as JSON."""

    def __call__(self) -> int:
        scenario = scenario_from(self)
        return _ride(self, scenario, self.output or dated())


def dated() -> Path:
    """A name of its own for a record that was given none, also beside others of this second."""
    now = time.time_ns()
    stem = time.strftime("%Y%m%d-%H%M%S", time.localtime(now // 10**9))
    return Path("runs") / f"{stem}-{now // 1000 % 10**6:06d}.h5"


def _video_path(command: Run, output: Path) -> Path | None:
    """Where the video goes, if there is to be one; refused before the run where it cannot."""
    if command.video is None:
        return None
    if len(command.video) > 1:
        raise InputError(f"--video: takes one file, not {len(command.video)}")
    path = command.video[0] if command.video else output.with_suffix(".mp4")
    check_kind(path, still=False)
    check_output(path, force=command.force)
    return path


def _ride(command: Run, scenario: Scenario, output: Path) -> int:
    from bikesim.cli.telling import inertia_told, summary_json, summary_told
    from bikesim.experiment.run import build, inertia_error, run
    from bikesim.experiment.summary import summarise
    from bikesim.experiment.watch import Watch
    from bikesim.record.reader import open_run

    picture = output.with_suffix(".png") if command.figure else None
    video = _video_path(command, output)
    check_apart(output, *filter(None, (command.scenario, picture, video)))
    if picture is not None:
        check_output(picture, force=command.force)
    parts = build(scenario)
    if (wrong := inertia_error(parts)) is not None:
        print(inertia_told(wrong), file=sys.stderr)
    with Watch(scenario.ticks, scenario.period).watching() as watch:
        run(parts, output, force=command.force, interrupted=watch)
    record = open_run(output)
    summary = summarise(record)
    if picture is not None:
        from bikesim.report.run_figure import run_figure
        from bikesim.report.style import save

        save(run_figure([record]), picture)
    if not command.json:
        print(summary_told(scenario, summary, picture), flush=True)
    filmed = video is not None and render_run(record, video, force=command.force)
    if command.json:
        told = summary_json(summary)
        print_json(told if video is None else {**told, "video": str(video) if filmed else None})
    elif filmed:
        print(f"video   {video}")
    if summary.reason.startswith("fault"):
        raise InputError(f"{summary.reason} at tick {summary.ticks}; kept: {summary.record}")
    return 0
