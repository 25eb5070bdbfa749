"""The drive of a profile."""

from bikesim.bench.cia402_drive import Cia402Drive
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.drive import Drive
from bikesim.bench.odrive_drive import ODrive
from bikesim.bench.odrive_settings import ODriveSettings


def make_drive(settings: Cia402Settings | ODriveSettings) -> Drive:
    """A kind of drive is a class of `Drive`, its settings, and a line here and in the profile."""
    if isinstance(settings, ODriveSettings):
        return ODrive(settings)
    return Cia402Drive(settings)
