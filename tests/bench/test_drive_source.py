"""A bench without a sensor node: the drive's encoder says where the bar is."""

from pathlib import Path

import numpy as np
import pytest

from bikesim.record.reader import open_run

from .lockstep import DRIVES, LockStep, leaning, profile
from .processes import Bench, written

ZERO = 0.31  # rad, what the encoder says of a straight bar


@pytest.mark.parametrize("kind", DRIVES)
@pytest.mark.parametrize("direction", [1, -1])
def test_its_zero_scale_and_sign(kind: str, direction: int):
    """Against the bar's own angle, at the tick before: that is how old the encoder's is."""
    drive = {**DRIVES[kind], "direction": direction}
    bar = {"inertia": 0.2311, "source": "drive", "drive_zero": ZERO}
    bench = LockStep(profile(drive, bar=bar), leaning())
    true: list[float] = []
    show = bench.plant.show

    def shown(bicycle) -> None:
        show(bicycle)
        true.append(bench.plant.steer)

    def hooked() -> None:
        bench.parts.rig.hooks = bench.parts.rig.hooks._replace(show=shown)

    assert bench.ride(before=hooked).reason == "end of run"
    steer = bench.rows.channel("steer")
    assert np.ptp(true) > 0.1
    assert steer[1:] == pytest.approx(true[:-1], abs=1.5e-3)


def test_a_profile_with_another_zero_is_off_by_it():
    bar = {"inertia": 0.2311, "source": "drive", "drive_zero": 0.0}
    real = profile(bar={**bar, "drive_zero": 0.02})
    bench = LockStep(profile(bar=bar), leaning(start={"roll_deg": 0.0}, duration=0.2), real=real)
    bench.ride()
    assert bench.rows.channel("steer")[0] == pytest.approx(0.02, abs=3e-4)


@pytest.mark.slow
@pytest.mark.real_time
def test_a_ride_over_a_bus(tmp_path: Path):
    """Host and bench are two processes, on udp_multicast; the drive is silent until it is asked."""
    bench = Bench(written("cia402-emulated", tmp_path, source="drive", drive_zero=ZERO))
    ridden = bench.until_in_time(
        "run", str(bench.path), "--duration", "1.5", "--set", "start.roll_deg=3", "-o", "r.h5"
    )
    assert ridden.returncode == 0, ridden.stderr
    run = open_run(tmp_path / "r.h5")
    time, true = np.array(bench.angles).T
    steer = run.channel("steer")
    off = [
        np.median(np.abs(np.interp(run.time + began, time, true) - steer))
        for began in np.arange(time[0], time[-1] - run.time[-1], 0.002)
    ]
    assert np.ptp(steer) > 0.02
    assert min(off) < 1e-3
