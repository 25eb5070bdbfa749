"""What a video costs against a bare MuJoCo renderer, whether it keeps up, and its memory.

Targets: a frame of one view, encoded, at most 1.15 times a bare loop over `mujoco.Renderer` on the
same scene, size and quality; both views in draft faster than real time; memory flat over the length
of the run, and below 1 GB.
"""

import os
import pickle
import resource
import subprocess
import sys
import tempfile
import time
from contextlib import nullcontext
from fractions import Fraction
from pathlib import Path

import numpy as np

from bikesim.record.reader import Run, open_run
from bikesim.view.crew import cores, workers_for
from bikesim.view.gl import Backend, find_backend
from bikesim.view.pose import Pose, PoseTrack
from bikesim.view.quality import Quality
from bikesim.view.video import Look, make_video

_LENGTH = 6.0  # [s] of video at 30 Hz
_WARM = 30  # frames that are not timed: the processes start, buffers fill
_ROUNDS = 5  # of the bare loop and the video in turn, so that a busy machine hits both


def main() -> None:
    """Prints each figure with its target."""
    backend = find_backend()
    print(f"  {backend.told}, {cores()} cores", flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for quality in (Quality.DRAFT, Quality.GOOD):
            _compare(folder, backend, quality)
        _keep_up(folder, backend)
        _remember(folder)


def _compare(folder: Path, backend: Backend, quality: Quality) -> None:
    look = Look(view="second", quality=quality)
    ride = _ridden(folder / f"{_LENGTH:g}.h5", _LENGTH)
    bare, ours = [], []
    for _ in range(_ROUNDS):
        bare.append(_bare(ride, look, backend))
        ours.append(_steady(ride, look, backend))
    ratio = np.divide(ours, bare)
    print(
        f"  one view, 1280x720, {quality}: bare loop {np.median(bare) * 1e3:.1f} ms, encoded video "
        f"{np.median(ours) * 1e3:.1f} ms a frame, {np.median(ratio):.2f} x, of {_ROUNDS} from "
        f"{ratio.min():.2f} to {ratio.max():.2f} (target: at most 1.15 x)",
        flush=True,
    )


def _keep_up(folder: Path, backend: Backend) -> None:
    ride = _ridden(folder / "30.h5", 30.0)
    before = _processor_time()
    took = _film(ride, Look(quality=Quality.DRAFT), backend)
    busy = _processor_time() - before
    print(
        f"  both views, 1280x720, 30 Hz, draft: 30 s of video in {took:.1f} s, "
        f"{30 / took:.2f} x real time (target: more than 1 x); processor time {busy:.1f} s",
        flush=True,
    )


def _remember(folder: Path) -> None:
    for length in (60.0, 600.0):
        record = folder / f"{length}.h5"
        _ridden(record, length)
        told = _own_process("memory", record, os.environ.copy())
        print(f"  memory for {length:g} s of video: {float(told):.0f} MB (target: flat, < 1000 MB)")


def _ridden(path: Path, duration: float) -> Run:
    if not path.exists():
        # Late, because what measures memory does not ride.
        from bikesim.experiment.run import build, run
        from bikesim.experiment.scenario import Scenario

        run(build(Scenario(duration=duration)), path)
    return open_run(path)


def _film(ride: Run, look: Look, backend: Backend) -> float:
    """Wall time of a video from its records to its file [s]."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        make_video([ride], Path(folder) / "video.mp4", look, backend)
        return time.perf_counter() - began


def _steady(ride: Run, look: Look, backend: Backend) -> float:
    """Wall time of a frame from the record to the closed file, once all processes draw [s]."""
    written = []

    def note() -> bool:
        written.append(time.perf_counter())
        return False

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "video.mp4"
        make_video([ride], path, look, backend, watch=lambda _: nullcontext(note))
        ended = time.perf_counter()
    return (ended - written[_WARM - 1]) / (len(written) - _WARM)


def _bare(ride: Run, look: Look, backend: Backend) -> float:
    """A frame of the bare loop [s], with all cores for OpenGL."""
    poses = [Pose(*row) for row in PoseTrack(ride).sampled(np.arange(0, _LENGTH, 1 / 30))]
    with tempfile.NamedTemporaryFile(suffix=".pickle") as file:
        pickle.dump((ride.bicycle, look, poses), file)
        file.flush()
        return float(_own_process("bare", Path(file.name), backend.environment(cores())))


def _processor_time() -> float:
    """Of this process and those that it has ended [s]."""
    return sum(os.times()[:4])


def _own_process(what: str, path: Path, environment: dict[str, str]) -> str:
    command = [sys.executable, "-m", "benchmarks.video", what, path]
    ran = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    return ran.stdout.split()[-1]


def _measure_bare(path: Path) -> float:
    from bikesim.view.picture import drawn_size, renderer
    from bikesim.view.scene import road_scene

    bicycle, look, poses = pickle.loads(path.read_bytes())
    scene = road_scene(bicycle)
    size = drawn_size(look.width, look.height, look.quality)
    made = renderer(scene.model, *size, look.quality)
    scene.prepare(made.scene)
    drawn = []
    for pose in poses:
        scene.show(pose)
        made.update_scene(scene.data, scene.camera(look.view), scene.option(look.view))
        made.render()
        drawn.append(time.perf_counter())
    made.close()
    return (drawn[-1] - drawn[_WARM - 1]) / (len(drawn) - _WARM)


def _measure_memory(path: Path) -> float:
    """All processes at their largest [MB]; the length counts, so a few frames a second will do."""
    ride, fps = open_run(path), Fraction(2)
    with tempfile.TemporaryDirectory() as folder:
        look = Look(quality=Quality.DRAFT)
        made = make_video([ride], Path(folder) / "video.mp4", look, find_backend(), fps=fps)
    own, child = (
        resource.getrusage(who).ru_maxrss / 1024
        for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return own + workers_for(made.planned) * child


if __name__ == "__main__":
    if sys.argv[1:2] == ["bare"]:
        print(_measure_bare(Path(sys.argv[2])))
    elif sys.argv[1:2] == ["memory"]:
        print(_measure_memory(Path(sys.argv[2])))
    else:
        main()
