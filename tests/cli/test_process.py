"""What only a real process can show: signals, kills, limits, pipes."""

import contextlib
import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bikesim.cli import entry
from bikesim.record.reader import open_run

LONG = ("run", "--duration", 400, "--output", "run.h5")


@pytest.fixture
def riding(process, tmp_path: Path):
    """A process in the middle of a long run, with some seconds of it on the disk."""
    began = process(*LONG)
    path, deadline = tmp_path / "run.h5", time.monotonic() + 30
    while not (path.exists() and open_run(path).ticks > 1000):
        assert began.poll() is None, began.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    yield began
    with contextlib.suppress(ProcessLookupError):
        began.kill()
    began.communicate()


@pytest.mark.parametrize(
    "number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP], ids=lambda s: s.name
)
def test_a_signal_ends_a_run_with_its_record_and_summary(riding, tmp_path: Path, number):
    riding.send_signal(number)
    out, err = riding.communicate(timeout=30)
    run = open_run(tmp_path / "run.h5")
    assert (riding.returncode, err) == (0, "")
    assert f"interrupted ({run.time[-1] + 0.001:.3f} s, {run.ticks} ticks)" in out
    assert "record  run.h5" in out
    assert run.complete
    assert run.ending is not None
    assert (run.ending.reason, run.ending.fell) == ("interrupted", False)
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


def test_a_record_in_use_is_not_taken_by_another_run(riding, process, tmp_path: Path):
    second = process("run", "--duration", 1, "--output", "run.h5", "--force")
    out, err = second.communicate(timeout=30)
    assert (second.returncode, out) == (2, "")
    assert err == "bikesim: run.h5: another run is writing it\n"
    assert riding.poll() is None


def test_two_runs_at_once_have_a_record_each(process, tmp_path: Path):
    both = [process("run", "--duration", 1) for _ in range(2)]
    assert [run.wait(30) for run in both] == [0, 0]
    assert len(list((tmp_path / "runs").glob("*.h5"))) == 2


class TestKilled:
    @pytest.fixture
    def killed(self, riding) -> None:
        riding.kill()
        assert riding.wait(30) == -signal.SIGKILL

    @pytest.mark.usefixtures("killed")
    def test_its_record_opens_and_info_says_so(self, cli):
        said = cli("info", "run.h5")
        assert said.status == 0
        assert "not closed: killed, or still running" in said.out.splitlines()[0]
        about = cli("info", "run.h5", "--json").json
        assert (about["complete"], about["reason"], about["fell"]) == (False, None, None)
        assert about["ticks"] > 1000

    @pytest.mark.usefixtures("killed")
    def test_its_record_can_be_replayed_drawn_and_exported(self, cli, tmp_path):
        figures = cli("replay", "run.h5", "--json").json
        assert figures["max_torque_error_N_m"] == 0
        assert cli("plot", "run.h5").status == 0
        assert cli("export", "run.h5", "run.csv").status == 0
        rows = (tmp_path / "run.csv").read_text().splitlines()
        assert len(rows) == figures["rows"] + 1


class TestFullDisk:
    """A limit on the size of files refuses the same writes as a disk that is full."""

    def test_in_the_middle_of_a_run_loses_nothing_that_was_written(self, riding, tmp_path: Path):
        limit = 2**20, resource.RLIM_INFINITY
        resource.prlimit(riding.pid, resource.RLIMIT_FSIZE, limit)
        out, err = riding.communicate(timeout=30)
        run = open_run(tmp_path / "run.h5")
        assert (riding.returncode, out) == (2, "")
        assert "run.h5: cannot be written: file too large; " in err
        assert f"the {run.ticks} ticks before" in err
        assert err.count("\n") == 1
        assert run.ticks > 1000

    def test_at_the_start_of_a_run_nothing_is_begun(self, process, tmp_path: Path):
        begun = process(
            *LONG, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2**20, 2**20))
        )
        out, err = begun.communicate(timeout=30)
        assert (begun.returncode, out) == (2, "")
        assert err.endswith("run.h5: cannot be written: file too large\n")
        assert err.count("\n") == 1
        assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [("--help",), ("info", "--keys"), ("eig", "--json", "--speeds", "0:10:0.1")],
    ids=" ".join,
)
class TestOutput:
    def test_a_pipe_that_nobody_reads_is_no_error(self, process, arguments):
        begun = process(*arguments)
        begun.stdout.close()
        assert begun.stderr.read() == ""
        assert begun.wait(30) == 0
        begun.stderr.close()

    def test_a_full_device_is_told_in_one_line(self, process, arguments):
        with Path("/dev/full").open("w") as full:
            begun = process(*arguments, stdout=full)
            _, err = begun.communicate(timeout=30)
        assert (begun.returncode, err) == (2, "bikesim: no space left on device\n")

    def test_none_at_all_is_no_error(self, tmp_path: Path, arguments):
        command = [sys.executable, "-m", "bikesim", *arguments]
        shell = ["sh", "-c", 'exec "$@" >&-', "sh", *command]
        ran = subprocess.run(shell, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (ran.returncode, ran.stderr) == (0, "")


def test_a_run_without_stderr_has_its_record(tmp_path: Path):
    command = [sys.executable, "-m", "bikesim", "run", "--duration", "0.1", "--output", "run.h5"]
    shell = ["sh", "-c", 'exec "$@" 2>&-', "sh", *command]
    assert subprocess.run(shell, cwd=tmp_path, capture_output=True, check=False).returncode == 0
    assert open_run(tmp_path / "run.h5").complete


@pytest.mark.parametrize("encoding", ["latin-1", "ascii"])
@pytest.mark.parametrize("arguments", [("info", "--keys"), ("run", "--set", "φ=1")], ids=" ".join)
def test_symbols_that_cannot_be_printed_are_no_error(process, encoding: str, arguments):
    begun = process(
        *arguments, env={**os.environ, "PYTHONIOENCODING": encoding}, encoding="latin-1"
    )
    _, err = begun.communicate(timeout=30)
    assert "Traceback" not in err
    assert begun.returncode == (2 if "run" in arguments else 0)


def test_a_run_into_a_pipe_that_nobody_reads_has_its_record(process, tmp_path: Path):
    begun = process("run", "--duration", 0.5, "--output", "run.h5")
    begun.stdout.close()
    assert (begun.wait(30), begun.stderr.read()) == (0, "")
    begun.stderr.close()
    assert open_run(tmp_path / "run.h5").complete


def test_two_processes_give_the_same_noise_bit_for_bit(process, cli, tmp_path: Path):
    both = [
        process("run", "--duration", 2, "--rig", "delft2013", "--output", name, "--json")
        for name in ("a.h5", "b.h5")
    ]
    for begun in both:
        out, _ = begun.communicate(timeout=60)
        assert json.loads(out)["ticks"] == 2000
    first, second = (cli("info", f"{name}.h5", "--json").json["digest"] for name in "ab")
    assert first == second


def test_the_status_of_a_refusal_is_2(process):
    begun = process("run", "--speed", 99)
    out, err = begun.communicate(timeout=30)
    assert (begun.returncode, out) == (2, "")
    assert err == "bikesim: speed = 99.0: must be at least 0 and at most 30\n"


def test_ctrl_c_where_nothing_can_be_finished(process):
    begun = process("eig", "--json", "--speeds", "0:100:0.001", preexec_fn=_takes_interrupts)
    time.sleep(2.5)
    assert begun.poll() is None
    begun.send_signal(signal.SIGINT)
    out, err = begun.communicate(timeout=30)
    assert (out, err) == ("", "bikesim: interrupted\n")
    assert begun.returncode in INTERRUPTED


# Where it meets an exec(), of a class that is being made say, Python ends by the signal itself;
# a shell tells 130 of both.
INTERRUPTED = (130, -signal.SIGINT)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP], ids=lambda s: s.name)
def test_a_signal_leaves_nothing_half_done(process, tmp_path: Path, number: int):
    begun = process("paper", "--output", "paper", preexec_fn=_takes_hangups)
    deadline = time.monotonic() + 30
    while not list(tmp_path.iterdir()):
        assert begun.poll() is None, begun.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    begun.send_signal(number)
    _, err = begun.communicate(timeout=30)
    assert err == "bikesim: interrupted\n"
    assert begun.returncode in INTERRUPTED
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_during_the_imports(monkeypatch: pytest.MonkeyPatch, capsys):
    class Interrupted:
        def find_spec(self, name: str, *_: object) -> None:
            if name == "bikesim.cli.main":
                raise KeyboardInterrupt

    monkeypatch.delitem(sys.modules, "bikesim.cli.main")
    monkeypatch.setattr(sys, "meta_path", [Interrupted(), *sys.meta_path])
    assert entry.main() == 130
    assert capsys.readouterr().err == "bikesim: interrupted\n"


def _takes_hangups() -> None:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def _takes_interrupts() -> None:
    # A shell that began the tests in the background has made their children deaf to it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
