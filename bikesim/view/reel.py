"""What a video takes from a record: a pose and the torques of each frame, and the curves."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bikesim.model.bicycle import Bicycle
from bikesim.view.pose import Pose, PoseTrack, needed
from bikesim.view.scenario import Shown
from bikesim.view.timeline import Timeline

if TYPE_CHECKING:
    from bikesim.record.reader import Run

Values = NDArray[np.float64]

# A curve has so many points for the time that a strip shows at once: two a pixel in HD.
WINDOW_SECONDS = 30.0
_POINTS_A_WINDOW = 2400
_HOLD = 1.5  # s of video


class Curves(NamedTuple):
    """Signals of a run over time, evenly spaced. Angles [deg], torques [N m]; no rider: empty."""

    time: Values
    roll: Values
    steer: Values
    feedback: Values
    rider: Values

    def until(self, time: float) -> int:
        """How many points there are up to a time [s]."""
        return int(np.searchsorted(self.time, time, side="right"))


class Moment(NamedTuple):
    """What one frame shows of a run. Torques [N m]; `rider` is NaN where it is not recorded."""

    pose: Pose
    feedback: float
    rider: float


@dataclass(frozen=True, eq=False)
class Reel:
    """A run as a video needs it. Times [s] are the record's.

    `torque_limit` [N m] is None where the scenario has none; `path` as in `road_scene`; `end_text`
    says why the run ended early, from `end_time` on, or is empty.
    """

    bicycle: Bicycle
    haptics: str
    haptics_on: bool
    poses: Values
    feedback: Values
    rider: Values
    curves: Curves
    first: float
    last: float
    torque_limit: float | None
    path: Values | None
    roll_cue: bool
    fell: bool
    end_text: str
    end_time: float

    def moment(self, frame: int) -> Moment:
        """What a frame shows."""
        pose = Pose(*self.poses[frame].tolist())
        return Moment(pose, float(self.feedback[frame]), float(self.rider[frame]))

    def ended(self, time: float) -> bool:
        """Whether a frame of this time [s] shows how the run ended."""
        return bool(self.end_text) and time >= self.end_time - 1e-9


def timeline(
    runs: Sequence["Run"], tracks: Sequence[PoseTrack], fps: Fraction, speed: float
) -> Timeline:
    """Of the longest of the runs; why that ended early stands long enough to be read."""
    run, longest = max(
        zip(runs, tracks, strict=True), key=lambda both: both[1].last - both[1].first
    )
    duration = longest.last - longest.first
    margin = duration / max(1, longest.ticks - 1) / 2
    return Timeline(duration, fps, speed, margin, _HOLD if _ending(run, longest)[0] else 0.0)


def make_reel(
    run: "Run", track: PoseTrack, elapsed: Values, *, roll_cue: bool | None = None
) -> Reel:
    """A run at so many times since its begin [s]; after its end it stays as it was there.

    `roll_cue`: whether the lean is to be seen; None: if the rider saw it. Raises InputError.
    """
    scenario = Shown(run)
    furthest = float(track.at(track.last).distance)
    times = np.minimum(track.first + elapsed, track.last)
    feedback = needed(run, "sent_torque")[: track.ticks]
    rider = run.channel("rider_torque")[: track.ticks] if "rider_torque" in run.names else None
    nothing = np.full(len(times), np.nan)
    end_text, end_time = _ending(run, track)
    return Reel(
        bicycle=run.bicycle,
        haptics="haptics off" if run.law == "off" else f"haptics on, law {run.law}",
        haptics_on=run.law != "off",
        poses=track.sampled(times),
        feedback=np.interp(times, track.time, feedback),
        rider=nothing if rider is None else np.interp(times, track.time, rider),
        curves=_curves(track, feedback, rider),
        first=track.first,
        last=track.last,
        torque_limit=scenario.torque_limit,
        path=scenario.path(furthest),
        roll_cue=scenario.roll_cue if roll_cue is None else roll_cue,
        fell=run.ending is not None and run.ending.fell,
        end_text=end_text,
        end_time=end_time,
    )


def _curves(track: PoseTrack, feedback: Values, rider: Values | None) -> Curves:
    duration = track.last - track.first
    spacing = max(min(duration, WINDOW_SECONDS) / _POINTS_A_WINDOW, 1e-4)
    time = np.append(np.arange(track.first, track.last, spacing), track.last)
    poses = track.sampled(time)
    roll, steer = (np.degrees(poses[:, Pose._fields.index(name)]) for name in ("roll", "steer"))
    return Curves(
        time,
        roll,
        steer,
        np.interp(time, track.time, feedback),
        np.empty(0) if rider is None else np.interp(time, track.time, rider),
    )


def _ending(run: "Run", track: PoseTrack) -> tuple[str, float]:
    if run.ending is None:
        return f"record cut short at {track.last:.1f} s", track.last
    if run.ending.fell:
        time = track.last if run.ending.fall_time is None else run.ending.fall_time
        return f"fell at {time:.1f} s", min(time, track.last)
    return "", track.last
