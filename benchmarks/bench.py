"""The bench loop against an emulated bench in another process, over udp_multicast.

Targets: compute time of a tick at 1 kHz, median at most 50 µs and p99 at most 100 µs (beside it,
what sending one frame takes by itself, of which a tick has one); lateness p99.9 at most 1.2 times
that of a bare loop under the same scheduling, beside the same emulated bench; no tick lost and no
false fault in the soak, memory flat; after kill -9 of the host the drive's torque is zero within
50 ms; the first 2 s of a recording, sent as sensor frames, give its torque within 0.05 N m.
`python -m benchmarks.bench --minutes 10` soaks longer (default: 1 for each drive).
"""

import argparse
import json
import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import can
import numpy as np
import tomli_w

from bikesim import bicycles
from bikesim.bench.emulator import Emulator, emulated_bus
from bikesim.bench.plant import Plant
from bikesim.bench.profile import load_bench
from bikesim.bench.recorded import torque_on_the_wire
from bikesim.bench.report import percentiles, timing_report
from bikesim.bench.scenario import bench_scenario
from bikesim.clock import RealTimeClock
from bikesim.experiment.scenario import Scenario
from bikesim.realtime import PRIORITY, real_time
from bikesim.record.reader import open_run
from bikesim.record.recording import read_recording

_RECORDING = Path(__file__).parents[2] / "shared" / "recordings" / "phobos_5mps.csv.gz"
_PERIOD = 1e-3  # s, of the benches that ship
_BARE = 60.0  # s
_DRIVES = ("cia402-emulated", "odrive-emulated")


def main(arguments: Sequence[str] = ()) -> None:
    """All of them, in turn."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=1.0, help="of each soak")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        for name in _DRIVES:
            _soak(name, Path(folder), options.minutes)
        for name in _DRIVES:
            _kill(name, Path(folder))
    _replayed()


def _profile(name: str, folder: Path) -> Path:
    """One that ships, where nobody else is: on a port of this process's own."""
    settings = load_bench(name)
    bus = settings.bus.model_copy(update={"arguments": {"port": 30_000 + os.getpid() % 10_000}})
    changed = settings.model_copy(update={"bus": bus})
    changed = changed.model_copy(update={"commissioned": changed.commissioning})
    path = folder / f"{name}.toml"
    path.write_text(tomli_w.dumps(changed.model_dump(mode="json", exclude_none=True)))
    return path


def _bikesim(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "bikesim", "bench", *map(str, arguments)]


def _soak(name: str, folder: Path, minutes: float) -> None:
    """A ride against the emulator in a process of its own; what was late, lost and grew."""
    profile, record = _profile(name, folder), folder / f"{name}.h5"
    seconds = 60 * minutes
    with subprocess.Popen(
        _bikesim("emulate", profile, "--duration", seconds + 120), stdout=subprocess.PIPE, text=True
    ) as bench:
        try:
            _wait_for(bench)
            with subprocess.Popen(
                _bikesim("run", profile, "--duration", seconds, "-o", record, "--json"),
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
            ) as ride:
                sizes = _sizes(ride)
                out, err = ride.communicate()
            bare = percentiles(_bare(min(seconds, _BARE)))
        finally:
            bench.terminate()
    if not out:
        print(f"  {name}: not ridden: {err.strip().splitlines()[-1]}")
        return
    said, run = json.loads(out), open_run(record)
    timing = timing_report(run)
    late, compute = percentiles(timing.late), percentiles(timing.compute)
    sent, system = (percentiles(one) for one in _sending(profile))
    print(f"  {name}: {said['reason']}; {said['ticks']} ticks, {timing.skipped} left out")
    print(f"    compute  p50 {compute['p50']:.0f}, p99 {compute['p99']:.0f} µs (50, 100)")
    print(
        f"             of which python-can's send of a frame takes p50 {sent['p50']:.0f}, p99 "
        f"{sent['p99']:.0f}, the system's {system['p50']:.0f} and {system['p99']:.0f}"
    )
    ratio = late["p99.9"] / bare["p99.9"]
    print(
        f"    late     p99.9 {late['p99.9']:.0f} µs, of a bare loop {bare['p99.9']:.0f}: "
        f"{ratio:.2f} x (1.2)"
    )
    print(f"    frames   {run.channel('frames_lost')[-1]:.0f} of the sensor lost")
    if len(sizes) > 4:
        early = sizes[len(sizes) // 4]
        print(f"    memory   {early:.1f} MB after a quarter, {sizes[-1]:.1f} at the end")


def _wait_for(bench: subprocess.Popen[str]) -> None:
    assert bench.stdout is not None
    for line in bench.stdout:
        if "Ctrl-C" in line:
            return


def _sizes(process: subprocess.Popen[str]) -> list[float]:
    """Resident memory each second, until it ends [MB]."""
    sizes: list[float] = []
    while process.poll() is None:
        try:
            pages = int(Path(f"/proc/{process.pid}/statm").read_text().split()[1])
        except (OSError, IndexError):
            break
        sizes.append(pages * os.sysconf("SC_PAGE_SIZE") / 1e6)
        time.sleep(1.0)
    return sizes


def _bare(seconds: float) -> np.ndarray:
    """Lateness [s] of a loop that only waits, under the same scheduling."""
    with real_time():
        clock = RealTimeClock(_PERIOD)
        late = []
        for _ in range(round(seconds / _PERIOD)):
            wake = clock.wait()
            late.append(wake.late + wake.skipped * _PERIOD)
    return np.array(late)


def _sending(profile: Path) -> tuple[np.ndarray, np.ndarray]:
    """How long [s] a frame takes to send once a tick, by python-can and by the system alone."""
    with can.Bus(**_wire(profile)) as bus, real_time():
        message = can.Message(arbitration_id=0x205, data=bytes(5), is_extended_id=False)
        bus.send(message)
        raw = socket.socket(fileno=os.dup(bus.fileno()))
        to = (_wire(profile)["channel"], _wire(profile)["port"])
        both = []
        for send in (lambda: bus.send(message), lambda: raw.sendto(bytes(110), to)):
            clock, took = RealTimeClock(_PERIOD), []
            for _ in range(5000):
                clock.wait()
                began = time.perf_counter()
                send()
                took.append(time.perf_counter() - began)
            both.append(np.array(took))
        raw.close()
    return both[0], both[1]


def _wire(profile: Path) -> dict[str, Any]:
    bus = load_bench(str(profile)).bus
    return {"interface": bus.interface, "channel": bus.channel, **bus.arguments}


def _kill(name: str, folder: Path) -> None:
    """kill -9 of the host in the middle of a ride; the emulated bench is in this process."""
    path = _profile(name, folder)
    settings = load_bench(str(path))
    scenario = bench_scenario(settings, Scenario())
    torques: list[tuple[float, float]] = []

    def watch(now: float, plant: Plant) -> None:
        torques.append((now, plant.torque))

    took = []
    for _ in range(3):
        torques.clear()
        command = _bikesim("run", path, "--duration", 60, "-o", folder / "killed.h5", "--force",
                           "--set", "start.roll_deg=1")  # fmt: skip
        with (
            emulated_bus(settings.bus) as bus,
            subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as host,
            real_time(PRIORITY - 5),
        ):
            emulator = Emulator(bus, settings, scenario, watch=watch)
            killed = _killed(emulator, host)
            if killed is None:
                continue
            took.append(_outlasted(torques, killed))
    told = ", ".join(took) or "never ridden"
    print(f"  {name}: torque after kill -9 of the host until {told} (50 ms)")


def _outlasted(torques: Sequence[tuple[float, float]], killed: float) -> str:
    """How long there was torque after the kill; without one at it there is nothing to measure."""
    before = [torque for now, torque in torques if now <= killed]
    if not before or not before[-1]:
        return "(no torque when it was killed: not measured)"
    return f"{1e3 * (max(now for now, torque in torques if torque) - killed):.0f} ms"


def _killed(emulator: Emulator, host: subprocess.Popen[bytes]) -> float | None:
    """When it was killed, 2 s into its ride; None if it never rode."""
    at: list[float] = []

    def over() -> bool:
        now, since = time.monotonic(), emulator.riding_since
        if not at and since is not None and now - since > 2.0:
            host.kill()
            at.append(now)
        return (bool(at) and now - at[0] > 0.3) or (not at and host.poll() is not None)

    emulator.run(over)
    return at[0] if at else None


def _replayed() -> None:
    """The recording's steer as sensor frames on a bus; the drive's frames against its command."""
    if not _RECORDING.exists():
        print("  no recording: ../shared is not there")
        return
    bicycle = bicycles.load("benchmark").with_gravity(9.80665)
    found = torque_on_the_wire(read_recording(_RECORDING), bicycle, 2.0)
    print(
        f"  {_RECORDING.name}, {found.ticks} ticks: torque on the wire at most {found.error:.3f} "
        f"N m from the recorded command of up to {found.largest:.2f} N m (0.05)"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
