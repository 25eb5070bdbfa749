"""Single pictures of a run, and its contact sheet."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from bikesim.errors import InputError, unknown
from bikesim.record.output import output_path, put_in_place, unwritable
from bikesim.record.reader import Run
from bikesim.view.crew import Crew
from bikesim.view.drawing import INK, Picture
from bikesim.view.film import Film
from bikesim.view.gl import Backend
from bikesim.view.pose import PoseTrack
from bikesim.view.strip import Strip, limits
from bikesim.view.video import Look, film_at

SUFFIXES = (".png", ".jpg")
_COLUMNS, _ROWS = 4, 3


def make_still(
    runs: Sequence[Run], time: float, output: Path, look: Look, backend: Backend, *, force: bool
) -> Path:
    """The frame of a time [s] of the record. Raises InputError for one outside the run."""
    target = _target(output, force=force)
    tracks = [PoseTrack(run) for run in runs]
    first, last = tracks[0].first, max(track.last for track in tracks)
    if not first - 1e-9 <= time <= last + 1e-9:
        raise InputError(f"--at {time:g}: outside the run, from {first:g} to {last:g} s")
    elapsed = np.array([time - first])
    film = film_at(runs, tracks, elapsed, look, backend)
    _save(_pictures(film, backend)[0], target, output)
    return output


def make_sheet(run: Run, output: Path, look: Look, backend: Backend, *, force: bool) -> Path:
    """Pictures from begin to end, and the signals of the whole run under them."""
    target = _target(output, force=force)
    track = PoseTrack(run)
    elapsed = np.linspace(0, track.last - track.first, _COLUMNS * _ROWS)
    cell = replace(
        look,
        view="second" if look.view in (None, "both") else look.view,
        width=look.width // _COLUMNS,
        height=look.height // (_ROWS + 1),
    )
    film = film_at([run], [track], elapsed, cell, backend)
    sheet = np.empty((look.height, look.width, 3), np.uint8)
    sheet[:] = INK
    gap = max(1, round(look.height / 360))
    for i, picture in enumerate(_pictures(film, backend)):
        x, y = i % _COLUMNS * cell.width, i // _COLUMNS * cell.height
        sheet[y : y + cell.height - gap, x : x + cell.width - gap] = picture[:-gap, :-gap]
    _draw_strip(film, sheet[_ROWS * cell.height :])
    _save(sheet, target, output)
    return output


def _draw_strip(film: Film, part: Picture) -> None:
    (reel,) = film.reels
    whole = limits(film.reels)._replace(window=max(1e-3, reel.last - reel.first))
    strip = Strip(reel.curves, whole, part.shape[1], part.shape[0], part.shape[0] / 200)
    strip.draw(part, reel.moment(len(film.elapsed) - 1))


def _pictures(film: Film, backend: Backend) -> list[Picture]:
    with Crew(film, range(len(film.elapsed)), "rgb24", backend) as crew:
        return [frame.copy() for frame in crew.frames()]


def _target(output: Path, *, force: bool) -> Path:
    if output.suffix.lower() not in SUFFIXES:
        raise unknown(f"kind of picture ({', '.join(SUFFIXES)})", output.suffix, SUFFIXES)
    return output_path(output, force=force)


def _save(picture: Picture, target: Path, output: Path) -> None:
    """Raises InputError for a disk that refuses it."""
    bgr = cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
    _, data = cv2.imencode(target.suffix.lower(), bgr)
    try:
        with put_in_place(target) as part:
            part.write_bytes(data.tobytes())
    except OSError as error:
        raise unwritable(output, error) from error
