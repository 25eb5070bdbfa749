"""The torque of a recorded run, for a rider who gives it again; and which file a torque is from."""

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from bikesim.errors import InputError
from bikesim.rider.settings import RiderSettings
from bikesim.rider.torque_file import check_samples
from bikesim.textfile import located, parse_toml

if TYPE_CHECKING:
    from bikesim.record.reader import Run

_CHANNEL = "rider_torque"

Samples = tuple[tuple[float, float], ...]


def with_recorded_torque(settings: RiderSettings) -> RiderSettings:
    """The same rider, with the torque of his record beside its name; others as they are.

    The record is looked up here because riders know nothing of records. Raises InputError.
    """
    script = settings.script
    if script is None or script.kind != "record" or script.samples:
        return settings
    file = Path(script.file or "")
    with located(f"rider.script.file {file}"):
        try:
            status = file.stat()
        except OSError as error:
            raise InputError((error.strerror or str(error)).lower()) from None
        samples = _samples(file, status.st_mtime_ns, status.st_size, script.inertia)
    played = script.model_copy(update={"samples": samples})
    return settings.model_copy(update={"script": played})


def with_file_digest(settings: RiderSettings) -> RiderSettings:
    """The same rider, with a digest of the file that his torque is from; others as they are.

    So a record says which torque it was, and riding it again notices where the file has changed.
    Raises InputError for a file that is not the one that the settings tell of.
    """
    script = settings.script
    if script is None or script.samples or not script.file:
        return settings
    file = Path(script.file)
    with located(f"rider.script.file {file}"):
        try:
            with file.open("rb") as content:
                found = hashlib.file_digest(content, "sha256").hexdigest()
        except OSError as error:
            raise InputError((error.strerror or str(error)).lower()) from None
        if script.digest not in (None, found):
            raise InputError(
                f"is another file than it was: its SHA-256 is {found[:12]}..., "
                f"rider.script.digest is {script.digest[:12]}...; without digest any file will do"
            )
    told = script.model_copy(update={"digest": found})
    return settings.model_copy(update={"script": told})


# A file's time and size are asked for so that one that has changed is read again.
@lru_cache(maxsize=4)
def _samples(file: Path, changed: int, size: int, inertia: float | None) -> Samples:
    """The torque as recorded; where it was not, as on a bench, that of the bar by eq. 5."""
    from bikesim.identify.bar import read_bar_torque
    from bikesim.record.reader import open_run
    from bikesim.record.recording import is_csv

    if is_csv(file) and inertia is None:
        raise InputError("a CSV does not say its handlebar's inertia; give rider.script.inertia")
    run = None if is_csv(file) else open_run(file)
    if run is None or _CHANNEL not in run.names:
        bar = read_bar_torque(file, inertia)
        samples = tuple(zip(bar.time.tolist(), bar.torque.tolist(), strict=True))
    elif inertia is not None:
        raise InputError(f"has the channel {_CHANNEL}: rider.script.inertia is of no use; leave it")
    else:
        samples = _recorded(run)
    check_samples(samples)
    return samples


def _recorded(run: "Run") -> Samples:
    # A tick has the torque of the physics step before it.
    step = parse_toml(run.scenario).get("physics_step", 0.0)
    times, torques = (run.time - step).tolist(), run.channel(_CHANNEL).tolist()
    return tuple(zip(times, torques, strict=True))[1:]
