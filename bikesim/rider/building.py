"""A rider from his settings, or those of a batch."""

from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from math import inf

import numpy as np

from bikesim.model.real import Real
from bikesim.rider.base import Brain, Rider, Setting
from bikesim.rider.body import BodyMaker
from bikesim.rider.custom import custom_brain
from bikesim.rider.figures import figure
from bikesim.rider.kinds import kind_of
from bikesim.rider.noise import Random
from bikesim.rider.person import Person
from bikesim.rider.settings import RiderSettings
from bikesim.rider.vision import VisionSettings


def make_rider(
    settings: RiderSettings,
    setting: Setting,
    vision: VisionSettings,
    random: np.random.Generator,
) -> Rider:
    """The rider of resolved settings, with his own source of noise. Raises InputError."""
    return _made([settings], setting, [vision], random)


def make_riders(
    settings: Sequence[RiderSettings],
    setting: Setting,
    visions: Sequence[VisionSettings],
    randoms: Sequence[np.random.Generator],
) -> Rider:
    """The riders of a batch as one, of arrays (n,): each does what he does alone.

    All have the same name; `setting.speed` may be an array (n,). Raises InputError.
    """
    return _made(settings, setting, visions, list(randoms))


def _made(
    settings: Sequence[RiderSettings],
    setting: Setting,
    visions: Sequence[VisionSettings],
    random: Random,
) -> Rider:
    shown = [inf if one.preview is None else one.preview for one in visions]
    setting = replace(setting, preview=_least(setting.preview, figure("vision.preview", shown)))
    if settings[0].custom:
        many = not isinstance(random, np.random.Generator)
        given = [one.figures or {} for one in settings]
        brain = custom_brain(settings[0].name, given, setting, many=many)
    else:
        brain = _brain(settings, setting)
    return Person(brain, BodyMaker(settings, setting, visions, random).body())


def _brain(settings: Sequence[RiderSettings], setting: Setting) -> Brain:
    kind = kind_of(settings[0].name)
    module, _, name = kind.brain.partition(":")
    given = {
        key: figure(f"rider.{key}", [getattr(one, key) for one in settings]) for key in kind.figures
    }
    known = {key: value for key, value in given.items() if value is not None}
    return getattr(import_module(module), name)(setting, **known)


def _least(a: Real, b: Real) -> Real:
    return np.minimum(a, b) if np.ndim(a) or np.ndim(b) else min(a, b)
