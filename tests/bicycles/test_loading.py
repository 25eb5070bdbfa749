import os
import shutil
import subprocess
import sys

import pytest

from bikesim import bicycles
from bikesim.bicycles.body import BODY_KEYS
from bikesim.errors import InputError
from bikesim.model.parameters import PARAMETER_NAMES, BicycleParameters


@pytest.fixture
def folder(shared, tmp_path, monkeypatch):
    """A working folder with the reference bicycles in it, where tests may write."""
    for file in (shared / "reference/bicycles").iterdir():
        shutil.copyfile(file, tmp_path / file.name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refusal(name) -> str:
    with pytest.raises(InputError) as caught:
        bicycles.load(name)
    message = str(caught.value)
    assert "\n" not in message
    return message


def parameters(name) -> BicycleParameters:
    found = bicycles.load(name).parameters
    assert found is not None
    return found


def without(text: str, *keys: str) -> str:
    return "\n".join(line for line in text.splitlines() if line.split("=")[0].strip() not in keys)


@pytest.mark.parametrize(
    "file",
    [
        "BenchmarkBenchmark",
        "BrowserBenchmark",
        "BrowserPar",
        "PistaPar",
        "RigidBenchmark",
        "RigidJasonPar",
        "RigidPar",
    ],
)
def test_every_reference_bicycle_loads(folder, file):
    bicycle = bicycles.load(f"{file}.txt")
    assert (bicycle.name, bicycle.gravity) == (file, 9.81)
    assert bicycle.wheelbase == parameters(f"{file}.txt").w


def test_a_path_object_works(folder):
    assert bicycles.load(folder / "PistaPar.txt").name == "PistaPar"


def test_a_file_is_taken_as_written(folder):
    assert parameters("BrowserPar.txt").IRxx == 0.0883819364527


def test_gravity_is_read_from_the_file(folder):
    text = (folder / "PistaPar.txt").read_text().replace("g=9.81", "g=1.62")
    (folder / "moon.txt").write_text(text)
    assert bicycles.load("moon.txt").gravity == 1.62


def test_gravity_is_9_81_where_the_file_has_none(folder):
    (folder / "bare.txt").write_text(without((folder / "PistaPar.txt").read_text(), "g"))
    assert bicycles.load("bare.txt").gravity == 9.81


def test_frame_and_rider_name_both(folder):
    bicycle = bicycles.load("BrowserBenchmark.txt+JasonBrowserBenchmark.txt")
    assert bicycle.name == "BrowserBenchmark+JasonBrowserBenchmark"
    assert parameters("BrowserBenchmark.txt+JasonBrowserBenchmark.txt").mB == 9.86 + 72.0


def test_a_frame_may_be_a_shipped_name(folder):
    assert parameters("browser+JasonBrowserBenchmark.txt").mB == 81.86 + 72.0


def test_a_file_with_a_plus_in_its_name_comes_first(folder):
    shutil.copyfile("PistaPar.txt", "BrowserBenchmark.txt+JasonBrowserBenchmark.txt")
    assert bicycles.load("BrowserBenchmark.txt+JasonBrowserBenchmark.txt").wheelbase == 0.989


def test_either_part_may_have_a_plus_in_its_name(folder):
    shutil.copyfile("BrowserBenchmark.txt", "a+b.txt")
    shutil.copyfile("JasonBrowserBenchmark.txt", "c+d.txt")
    assert parameters("a+b.txt+c+d.txt").mB == 9.86 + 72.0


@pytest.mark.parametrize(
    ("name", "near"), [("benchmrak", "benchmark"), ("Browser", "browser"), ("rigd", "rigid")]
)
def test_an_unknown_bicycle_names_the_near_ones(name, near):
    assert f"unknown bicycle '{name}'; did you mean {near}" in refusal(name)


@pytest.mark.parametrize("name", ["", "zzzzzz", "x" * 5000, "\0"])
def test_a_name_like_none_lists_all(name):
    assert "known: benchmark, browser, davis" in refusal(name)


@pytest.mark.parametrize("name", ["nothere.txt", "./benchmark", "no/such/folder"])
def test_a_missing_file(name):
    assert refusal(name).startswith(f"{name}: no such bicycle file")


def test_a_missing_rider_file(folder):
    assert refusal("PistaPar.txt+nobody.txt") == "nobody.txt: no such file or directory"


def test_a_missing_frame_file(folder):
    assert refusal("no.txt+JasonRigidBenchmark.txt").startswith("no.txt: no such bicycle file")


def test_no_rider_after_the_plus(folder):
    assert "lacks the rider's file" in refusal("PistaPar.txt+")


def test_a_folder(folder):
    assert refusal(str(folder)) == f"{folder}: is a folder; give a bicycle file in it"


@pytest.mark.parametrize(
    ("content", "what"),
    [
        (b"", "the file is empty"),
        (b" \n\n", "the file is empty"),
        (b"\x89HDF\r\n\x1a\n\xff", "is not a text file"),
        (b"w=1\0", "is not a text file"),
        (b"#" * 1_000_001, "is not a bicycle file"),
    ],
)
@pytest.mark.parametrize("file", ["b.txt", "b.toml"])
def test_a_file_of_another_kind(folder, file, content, what):
    (folder / file).write_bytes(content)
    assert refusal(file).startswith(f"{file}: {what}")


def test_a_device_is_not_read():
    assert "is not a bicycle file" in refusal(os.devnull)


def test_a_file_that_lacks_parameters_names_them(folder):
    (folder / "b.txt").write_text(without((folder / "PistaPar.txt").read_text(), "w", "IFyy"))
    assert refusal("b.txt") == "b.txt: lacks w, IFyy (a bicycle has 25 parameters)"


def test_a_rider_alone_is_no_bicycle(folder):
    message = refusal("JasonRigidBenchmark.txt")
    assert message.startswith("JasonRigidBenchmark.txt: has a rider's part only, lacks w, c, lam")
    for name in set(PARAMETER_NAMES) - set(BODY_KEYS):
        assert name in message


def test_a_bicycle_is_no_rider(folder):
    assert refusal("PistaPar.txt+RigidPar.txt").startswith("RigidPar.txt: is a bicycle, not a")


def test_a_rider_that_lacks_a_value(folder):
    (folder / "r.txt").write_text("mB=70\nxB=0.3\nzB=-1\n")
    assert refusal("PistaPar.txt+r.txt").startswith("r.txt: lacks IBxx, IByy, IBzz, IBxz")


def test_no_rider_on_matrices(folder):
    assert "known by its matrices only" in refusal("davis+JasonRigidBenchmark.txt")


def test_a_value_out_of_range_names_file_key_value_and_range(folder):
    text = (folder / "PistaPar.txt").read_text().replace("mH=2.27", "mH=-2.27")
    (folder / "b.txt").write_text(text)
    assert refusal("b.txt") == "b.txt: bicycle parameter mH = -2.27: must be above 0"


def test_a_bad_number_names_the_line(folder):
    text = (folder / "PistaPar.txt").read_text().replace("rF=0.3", "rF=O.3")
    (folder / "b.txt").write_text(text)
    assert refusal("b.txt").startswith("b.txt, line 2: rF = 'O.3")


def test_the_package_imports_no_numpy():
    code = "import sys, bikesim.bicycles as b; b.names(); sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_loading_imports_neither_scipy_nor_mujoco():
    code = (
        "import sys, bikesim.bicycles as b; b.load('browser'); "
        "sys.exit(bool({'scipy', 'mujoco', 'h5py', 'matplotlib', 'pydantic'} & set(sys.modules)))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
