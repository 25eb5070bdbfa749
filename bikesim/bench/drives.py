"""The kinds of drives, in one table: what a profile says of one, the host's side, its emulation."""

from collections.abc import Callable
from typing import Any, NamedTuple

from bikesim.bench.cia402_drive import Cia402Drive
from bikesim.bench.cia402_settings import Cia402Settings
from bikesim.bench.drive import Drive
from bikesim.bench.emulated.cia402_drive import EmulatedDrive
from bikesim.bench.emulated.device import DriveDevice
from bikesim.bench.emulated.motor import Motor
from bikesim.bench.emulated.odrive import EmulatedODrive, ODriveConfiguration
from bikesim.bench.odrive_drive import ODrive
from bikesim.bench.odrive_settings import ODriveSettings

DriveSettings = Cia402Settings | ODriveSettings
"""Of a profile's [drive]; its `kind` tells which."""


class DriveKind(NamedTuple):
    """Both sides of the bus, each made of the profile's settings of this kind."""

    host: Callable[[Any], Drive]
    emulated: Callable[[Any], DriveDevice]


KINDS: dict[type[DriveSettings], DriveKind] = {
    Cia402Settings: DriveKind(
        Cia402Drive, lambda drive: EmulatedDrive(drive.node, Motor.of_profile(drive))
    ),
    ODriveSettings: DriveKind(
        ODrive, lambda drive: EmulatedODrive(drive.node, ODriveConfiguration.of_profile(drive))
    ),
}


def make_drive(settings: DriveSettings) -> Drive:
    """The host's side of a profile's drive."""
    return KINDS[type(settings)].host(settings)


def emulated_drive(settings: DriveSettings) -> DriveDevice:
    """The drive that a profile expects, as a device of an emulated bench."""
    return KINDS[type(settings)].emulated(settings)
