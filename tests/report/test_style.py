import os
import re
import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import matplotlib.image
import matplotlib.pyplot as plt
import pytest

from bikesim.errors import InputError
from bikesim.report.style import BLUE, figure, label, save, styled


def drawn():
    with styled():
        made = figure(3, 2)
        axes = made.subplots()
        axes.plot([0, 1], [0, 1], color=BLUE)
        label(axes, x="time [s]", y="roll φ [deg]", title="a title")
    return made


def test_nothing_of_the_style_stays_in_matplotlib():
    before = dict(mpl.rcParams)
    with styled():
        assert mpl.rcParams["axes.grid"] is True
    assert dict(mpl.rcParams) == before


def test_nor_after_an_error():
    before = dict(mpl.rcParams)
    with pytest.raises(ZeroDivisionError), styled():
        raise ZeroDivisionError
    assert dict(mpl.rcParams) == before


def test_nor_after_a_figure_is_written(tmp_path: Path):
    before = dict(mpl.rcParams)
    save(drawn(), tmp_path / "figure.svg")
    assert dict(mpl.rcParams) == before


def test_no_figure_is_known_to_pyplot():
    drawn()
    assert plt.get_fignums() == []


def test_labels():
    (axes,) = drawn().axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time [s]", "roll φ [deg]")
    assert axes.get_title("left") == "a title"


def test_png_of_its_size(tmp_path: Path):
    picture = matplotlib.image.imread(save(drawn(), tmp_path / "figure.png"))
    assert picture.shape[:2] == (2 * 160, 3 * 160)
    assert picture.std() > 0.01


@pytest.mark.parametrize(
    ("kind", "start"), [("pdf", b"%PDF"), ("svg", b"<?xml"), ("PNG", b"\x89P")]
)
def test_kinds(tmp_path: Path, kind: str, start: bytes):
    assert save(drawn(), tmp_path / f"figure.{kind}").read_bytes().startswith(start)


@pytest.mark.parametrize("kind", ["png", "pdf", "svg"])
def test_the_same_figure_is_the_same_file(tmp_path: Path, kind: str):
    first, second = (save(drawn(), tmp_path / f"{name}.{kind}") for name in "ab")
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.parametrize("kind", ["png", "pdf", "svg"])
def test_no_file_says_when_it_was_made(tmp_path: Path, kind: str):
    data = save(drawn(), tmp_path / f"figure.{kind}").read_bytes()
    assert not re.search(rb"CreationDate|<dc:date>|tIME", data)


def test_a_home_that_cannot_be_written_is_not_complained_of(tmp_path: Path):
    (tmp_path / "home").touch()  # a file, in which not even root can make a folder
    hidden = ("MPLCONFIGDIR", "XDG_CONFIG_HOME", "XDG_CACHE_HOME")
    environment = {key: value for key, value in os.environ.items() if key not in hidden}
    code = "import bikesim.report.eigenvalue_figure, matplotlib; matplotlib.get_cachedir()"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**environment, "HOME": str(tmp_path / "home")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""


def test_folders_are_made(tmp_path: Path):
    assert save(drawn(), tmp_path / "a/b/figure.png").is_file()


def test_an_unknown_kind(tmp_path: Path):
    with pytest.raises(InputError, match=r"cannot draw to '\.gif'; known: \.png, \.pdf, \.svg"):
        save(drawn(), tmp_path / "figure.gif")


def test_what_cannot_be_written_leaves_nothing(tmp_path: Path):
    (tmp_path / "figure.png").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        save(drawn(), tmp_path / "figure.png")
    assert [path.name for path in tmp_path.iterdir()] == ["figure.png"]
