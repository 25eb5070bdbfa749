import xml.etree.ElementTree
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest


def test_beside_the_record_by_default(cli, record: Path):
    said = cli("plot", "run.h5")
    assert (said.status, said.out) == (0, "figure  run.png\n")


def test_the_png_is_a_picture_with_the_lines_in_their_colours(cli, record: Path):
    cli("plot", "run.h5")
    picture = matplotlib.image.imread("run.png")
    height, width, _ = picture.shape
    assert height > width > 1000
    colours = {tuple(colour) for colour in (255 * picture[::2, ::2, :3].reshape(-1, 3)).round()}
    assert {(0x00, 0x72, 0xB2), (0xE6, 0x9F, 0x00)} <= colours
    assert np.mean(picture[..., :3] < 0.9) > 0.01


def test_the_pdf_keeps_its_text_as_text(cli, record: Path):
    cli("plot", "run.h5", "--output", "run.pdf")
    data = Path("run.pdf").read_bytes()
    assert data.startswith(b"%PDF-")
    assert data.rstrip().endswith(b"%%EOF")
    assert b"/FontFile2" in data


def test_the_svg_is_xml(cli, record: Path):
    cli("plot", "run.h5", "-o", "run.svg")
    root = xml.etree.ElementTree.parse("run.svg").getroot()
    assert root.tag.endswith("svg")
    assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) > 20


def test_several_runs_on_the_same_axes(cli, record: Path):
    cli("run", "--law", "off", "--duration", 1, "--output", "off.h5")
    assert cli("plot", "run.h5", "off.h5", "-o", "both.svg").status == 0
    cli("plot", "run.h5", "-o", "one.svg")
    assert Path("both.svg").stat().st_size > Path("one.svg").stat().st_size


def test_a_figure_that_is_there_stays_without_force(cli, refusal, record: Path):
    Path("run.png").write_text("precious")
    assert "run.png: is already there; --force replaces it" in refusal("plot", "run.h5")
    assert Path("run.png").read_text() == "precious"
    assert cli("plot", "run.h5", "--force").status == 0


def test_a_record_is_never_drawn_over(refusal, record: Path):
    named = record.rename("run.png")
    before = named.read_bytes()
    assert "run.png: would replace" in refusal("plot", "run.png", "--force")
    assert named.read_bytes() == before


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("run.jpg", "run.jpg: cannot draw to '.jpg'; known: .png, .pdf, .svg"),
        ("run", "run: cannot draw to ''"),
        ("/proc/run.png", "/proc/run.png: cannot be written"),
        ("run.h5/run.png", "run.h5/run.png: cannot be written: run.h5 is not a folder"),
    ],
)
def test_an_output_that_cannot_be(refusal, record: Path, output: str, message: str):
    assert message in refusal("plot", "run.h5", "-o", output)


def test_without_a_record(refusal):
    assert refusal("plot") == "bikesim: RUN.h5 is missing (bikesim plot --help)\n"
