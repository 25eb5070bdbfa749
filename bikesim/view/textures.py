"""What is painted on ground, road and sky: the same on every machine, from fixed seeds."""

import math
from functools import cache

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from bikesim.view.shapes.colour import palette

Array = NDArray[np.float64]

GRASS_PERIOD = 24.0  # m, and 1 / the texrepeat of the material in mjcf/world.xml
ASPHALT_PERIOD = 12.0  # m
ROWS_PERIOD = 12.0  # m
_HAZE = (0.80, 0.86, 0.89)  # over the horizon
_SUN = (-0.44, 0.36, 0.82)  # towards it: against the light's direction in mjcf/world.xml
_ZENITH = (0.25, 0.49, 0.80)
_CLOUD = (0.99, 0.98, 0.97)
_FACE = 768  # pixels a side of a face of the sky
_UP, _DOWN = 2, 3  # the faces above and below; the one below is never seen
_DIP = 4  # rows below the middle of a face, from where on there is only haze


def paint(spec: mujoco.MjSpec) -> None:
    """Puts the painted textures in the place of the plain ones of mjcf/world.xml."""
    replace_texture(spec.texture("grass"), grass())
    replace_texture(spec.texture("asphalt"), asphalt())
    replace_texture(spec.texture("rows"), rows())
    replace_texture(spec.texture("colours"), palette())
    replace_texture(spec.texture("sky"), sky())


def replace_texture(texture: mujoco.MjsTexture, pixels: NDArray[np.uint8]) -> None:
    """Gives a texture of a model that is being made its pixels, (rows, columns, 3)."""
    texture.builtin = mujoco.mjtBuiltin.mjBUILTIN_NONE
    texture.height, texture.width = pixels.shape[:2]
    texture.nchannel = 3
    texture.data = pixels.tobytes()


def noise(size: int, slope: float, seed: int, *, coarsest: float = 1.0) -> Array:
    """A square (size, size) that repeats without a seam, mean 0 and deviation 1.

    Its amplitude falls with frequency to the power `slope`; `coarsest` is the lowest, in waves.
    """
    across, down = np.fft.rfftfreq(size, 1 / size), np.fft.fftfreq(size, 1 / size)
    frequency = np.hypot(down[:, None], across[None, :])
    amplitude = np.where(frequency >= coarsest, np.maximum(frequency, 1.0) ** -slope, 0.0)
    white = np.random.default_rng(seed).standard_normal((size, size))
    field = np.fft.irfft2(np.fft.rfft2(white) * amplitude, (size, size))
    return (field - field.mean()) / field.std()


@cache
def grass() -> NDArray[np.uint8]:
    """A meadow of `GRASS_PERIOD`: blades, tufts, drier patches."""
    size = 1024
    fine, tufts = noise(size, 0.35, 1, coarsest=40), noise(size, 1.3, 2, coarsest=5)
    dry = _smooth(0.2, 1.8, noise(size, 1.8, 3, coarsest=2))
    light, dry = 1 + 0.10 * fine + 0.085 * tufts, 0.55 * dry
    colours = zip((0.43, 0.565, 0.265), (0.60, 0.62, 0.34), strict=True)
    return np.stack(
        [_bytes((green + dry * (straw - green)) * light) for green, straw in colours], 2
    )


@cache
def asphalt() -> NDArray[np.uint8]:
    """A road surface of `ASPHALT_PERIOD`: grain, stains, a joint across."""
    size = 512
    light = 1 + 0.060 * noise(size, 0.1, 4, coarsest=30) + 0.035 * noise(size, 1.4, 5, coarsest=2)
    column = np.arange(size)
    crooked = np.rint(size / 2 + 5 * noise(size, 1.5, 6, coarsest=2)[0]).astype(int)
    for width, dark in ((2, 0.80), (1, 0.72)):
        for offset in range(-width + 1, width):
            light[column, (crooked + offset) % size] *= dark
    return _bytes(np.array([0.475, 0.48, 0.495]) * light[..., None])


@cache
def rows() -> NDArray[np.uint8]:
    """A field of `ROWS_PERIOD` in eight rows along x, without a colour of its own."""
    size = 256
    across = np.sin(2 * math.pi * 8 * np.arange(size) / size)[:, None]
    light = 0.80 + 0.10 * across + 0.05 * noise(size, 0.4, 21, coarsest=8)
    return _bytes(np.repeat((light + 0.03 * noise(size, 1.3, 22))[..., None], 3, axis=2))


@cache
def sky() -> NDArray[np.uint8]:
    """The six faces one below the other, in OpenGL's order: +x -x +y -y +z -z of a y-up cube."""
    faces = np.empty((6, _FACE, _FACE, 3), np.uint8)
    faces[:] = _bytes(np.array(_HAZE))
    for face in range(6):
        rows = {_UP: _FACE, _DOWN: 0}.get(face, _FACE // 2 + _DIP)
        faces[face, :rows] = _bytes(sky_colour(_directions(face, rows)))
    return faces.reshape(-1, _FACE, 3)


@cache
def road_ahead() -> NDArray[np.uint8]:
    """The road as a rider sees it, for the screen of the bench: upper rows first."""
    rows, columns = 216, 384
    across, up = np.linspace(-0.9, 0.9, columns)[None, :], np.linspace(0.32, -0.68, rows)[:, None]
    looking = np.stack(np.broadcast_arrays(1.0, -across, up), -1)
    colour = sky_colour(looking / np.linalg.norm(looking, axis=-1, keepdims=True))
    below = looking[..., 2] < -0.004
    x, y = (1.5 * looking[below, k] / -looking[below, 2] for k in (0, 1))
    land = np.empty((len(x), 3))
    land[:] = (0.44, 0.57, 0.28)
    on_road = np.abs(y - 1.75) < 3.9
    land[on_road] = (0.47, 0.48, 0.50)
    dashes = (np.abs(y - 1.75) < 0.07) & (x % 12 < 3.5)
    land[dashes | (np.abs(np.abs(y - 1.75) - 3.5) < 0.07)] = 0.95
    land[np.abs(y) < 0.08] = (0.99, 0.80, 0.17)
    colour[below] = land
    return _bytes(colour)


def _directions(face: int, rows: int) -> Array:
    """Where the pixels of a face's first rows look in the world: x forward, y left, z up."""
    step = (2 * np.arange(_FACE) + 1) / _FACE - 1
    s, t = step[None, :], step[:rows, None]
    x, y, z = (
        (1, -t, -s), (-1, -t, s), (s, 1, t), (s, -1, -t), (s, -t, 1), (-s, -t, -1),
    )[face]  # fmt: skip
    looking = np.empty((rows, _FACE, 3))
    for axis, along in enumerate((x, -z, y)):  # y up there is z up here
        looking[..., axis] = along
    looking /= np.sqrt(1 + s * s + t * t)[..., None]
    return looking


def sky_colour(looking: Array) -> Array:
    """The colour of the sky in given directions."""
    elevation = np.arcsin(np.clip(looking[..., 2], -1, 1))
    above = np.exp(np.maximum(elevation, 0) / -0.32)
    colour = _mixed(_ZENITH, _HAZE, above)
    sun = np.clip(looking @ (np.array(_SUN) / np.linalg.norm(_SUN)), 0, 1)
    glow = sun > 0.6
    _cover(colour, (1.0, 0.97, 0.88), 0.22 * sun[glow] ** 12 + 0.35 * sun[glow] ** 250, glow)
    high = elevation > 0.05
    clouds = _cloud_cover(looking[high], elevation[high])
    colour[high] = _mixed(colour[high], _CLOUD, 0.88 * clouds)
    disc = sun > 0.999
    _cover(colour, (1.0, 0.99, 0.95), _smooth(0.99945, 0.99965, sun[disc]), disc)
    low = elevation < 0.12
    azimuth = np.arctan2(looking[low, 1], looking[low, 0])
    colour[low] = _with_hills(colour[low], azimuth, elevation[low])
    return colour


def _cloud_cover(looking: Array, elevation: Array) -> Array:
    """Fair-weather clouds: a flat layer, seen in perspective, that thins out to the horizon."""
    u, v = (looking[..., k] / looking[..., 2] * 46 for k in (0, 1))
    density = _sampled(_cloud_layer(), u, v)
    return _smooth(0.35, 1.9, density) * _smooth(0.05, 0.30, elevation)


@cache
def _cloud_layer() -> Array:
    return noise(512, 1.75, 8, coarsest=3)


def _with_hills(colour: Array, azimuth: Array, elevation: Array) -> Array:
    """Two ridges and a line of woods, the farther the paler; below the horizon only haze."""
    for seed, height, base, strength in (
        (11, 0.030, 0.036, 0.30),
        (12, 0.019, 0.020, 0.50),
        (13, 0.006, 0.007, 0.62),
    ):
        inside = _smooth(-0.0012, 0.0012, base + height * _around(azimuth, seed) - elevation)
        wood = np.add((0.36, 0.49, 0.58), strength * np.array((-0.03, -0.02, -0.16)))
        hill = _mixed(_HAZE, wood, strength * _smooth(-0.004, 0.022, elevation))
        colour = colour + inside[..., None] * (hill - colour)
    return _mixed(colour, _HAZE, _smooth(0.0, 0.004, -elevation))


def _around(azimuth: Array, seed: int) -> Array:
    """A ridge by azimuth [rad], about -1 to 1, that closes after a turn."""
    angles, ridge = _ridge(seed)
    return np.interp(azimuth, angles, ridge) / 0.9


@cache
def _ridge(seed: int) -> tuple[Array, Array]:
    chance = np.random.default_rng(seed)
    angles = np.linspace(-math.pi, math.pi, 4097)
    waves = np.arange(3, 90)[:, None]
    size = chance.normal(size=waves.shape) / waves**1.15
    phase = chance.uniform(0, 2 * math.pi, waves.shape)
    return angles, (size * np.cos(waves * angles + phase)).sum(0)


def _sampled(square: Array, u: Array, v: Array) -> Array:
    """Between the pixels of a square that repeats."""
    size = len(square)
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b = u - i, v - j
    i, j, k, m = i % size, j % size, (i + 1) % size, (j + 1) % size
    return (1 - a) * ((1 - b) * square[i, j] + b * square[i, m]) + a * (
        (1 - b) * square[k, j] + b * square[k, m]
    )


def _smooth(low: float, high: float, value: Array) -> Array:
    """From 0 at `low` to 1 at `high`, level at both."""
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def _mixed(first: ArrayLike, second: ArrayLike, share: Array) -> Array:
    a, b = np.asarray(first, float), np.asarray(second, float)
    mixed = np.empty((*share.shape, 3))
    for k in range(3):  # one channel at a time: NumPy is slow along an axis of three
        mixed[..., k] = a[..., k] + share * (b[..., k] - a[..., k])
    return mixed


def _cover(colour: Array, by: ArrayLike, share: Array, where: NDArray[np.bool_]) -> None:
    """Mixes a colour in, in place, by its share of each place where there is any."""
    colour[where] = _mixed(colour[where], by, np.clip(share, 0, 1))


def _bytes(colour: Array) -> NDArray[np.uint8]:
    return np.rint(255 * np.clip(colour, 0, 1)).astype(np.uint8)
