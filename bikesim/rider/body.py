"""Everything human of a rider from his settings: what is not asked for is left out."""

from collections.abc import Iterator, Sequence

import numpy as np

from bikesim.model.real import Real
from bikesim.rider.base import Arms, Setting, Sight
from bikesim.rider.delay import Late, Signals, delay_line
from bikesim.rider.figures import figure
from bikesim.rider.grip import Grip
from bikesim.rider.muscle import Neuromuscular, Strength
from bikesim.rider.noise import Noise, Random, coloured_noise, spawned
from bikesim.rider.person import Body
from bikesim.rider.schedule import Schedule
from bikesim.rider.senses import Balance, Display, Eyes, Felt, Hands, Turned
from bikesim.rider.settings import RiderSettings
from bikesim.rider.vision import VisionSettings

# Each with the key of its bandwidth, in the order of their sources.
_VISUAL = "visual_noise_bandwidth"
_PROPRIOCEPTIVE = "proprioceptive_noise_bandwidth"
_NOISES = (
    ("visual_roll_noise", _VISUAL),
    ("visual_roll_rate_noise", _VISUAL),
    ("visual_heading_noise", _VISUAL),
    ("visual_deviation_noise", _VISUAL),
    ("vestibular_noise", "vestibular_noise_bandwidth"),
    ("proprioceptive_steer_noise", _PROPRIOCEPTIVE),
    ("proprioceptive_steer_rate_noise", _PROPRIOCEPTIVE),
)


class BodyMaker:
    """Makes the body of one rider, or with many sources of noise that of a batch's."""

    def __init__(
        self,
        settings: Sequence[RiderSettings],
        setting: Setting,
        visions: Sequence[VisionSettings],
        random: Random,
    ) -> None:
        self._all, self._visions, self._setting = settings, visions, setting
        self._random, self._many = random, not isinstance(random, np.random.Generator)

    def body(self) -> Body:
        """All that was asked for."""
        noises = self._sensory_noises()
        arms = self._arms("arm_damping", "arm_stiffness")
        before = self._before()
        return Body(
            display=self._display(before),
            arms=arms,
            eyes=Eyes(*noises[:4]) if any(noises[:4]) else None,
            seen_late=delay_line(self._seen_delay(), self._setting.step, before),
            balance=self._balance(noises[4]),
            hands=Hands(*noises[5:]) if any(noises[5:]) else None,
            felt_late=self._late("proprioceptive_delay", Felt(*self._zeros(2))),
            strength=self._strength(),
            muscle=self._muscle(),
            remnant=self._noise("remnant_rms", "remnant_bandwidth", self._random),
            grip=self._grip(arms),
        )

    def _figure(self, key: str) -> Real:
        return figure(f"rider.{key}", [getattr(one, key) for one in self._all])

    def _or_zero(self, key: str) -> Real:
        """A figure, 0 of a rider who has none of the kind."""
        value = self._figure(key)
        return 0.0 if value is None else value

    def _zeros(self, count: int) -> Iterator[Real]:
        return (np.zeros(len(self._all)) if self._many else 0.0 for _ in range(count))

    def _before(self) -> Sight:
        """What he has seen before anything reaches him: the bicycle at rest on the path."""
        return Sight(0.0, self._setting.speed, *self._zeros(6))

    def _display(self, before: Sight) -> Display:
        cue = figure("vision.roll_cue", [float(one.roll_cue) for one in self._visions])
        return Display(self._setting.path, before, cue, self._light())

    def _light(self) -> Schedule | None:
        """1 or 0 by the time of what the display shows late: it was so when that happened."""
        each = [
            [
                (time - one.delay, light)
                for interval in one.occlusions
                for time, light in zip(interval, (0.0, 1.0), strict=True)
            ]
            for one in self._visions
        ]
        return Schedule(1.0, each) if any(each) else None

    def _seen_delay(self) -> Real:
        """The eyes' and the display's [s]."""
        each = zip(self._all, self._visions, strict=True)
        delays = [(rider.visual_delay or 0.0) + vision.delay for rider, vision in each]
        return figure("rider.visual_delay", delays)

    def _late(self, key: str, before: Signals) -> Late | None:
        return delay_line(self._or_zero(key), self._setting.step, before)

    def _balance(self, noise: Noise | None) -> Balance | None:
        share = self._or_zero("vestibular_share")
        if not np.any(share):
            return None
        return Balance(share, noise, self._late("vestibular_delay", Turned(*self._zeros(1))))

    def _sensory_noises(self) -> list[Noise | None]:
        """Each has a source of its own, so that the remnant is the same with and without them."""
        if not any(getattr(one, key) for one in self._all for key, _ in _NOISES):
            return [None] * len(_NOISES)
        sources = spawned(self._random, len(_NOISES))
        return [
            self._noise(size, bandwidth, source)
            for (size, bandwidth), source in zip(_NOISES, sources, strict=True)
        ]

    def _noise(self, size: str, bandwidth: str, random: Random) -> Noise | None:
        rms = self._or_zero(size)
        if not np.any(rms):
            return None
        return coloured_noise(rms, self._figure(bandwidth), self._setting.step, random)

    def _strength(self) -> Strength | None:
        limit = self._figure("torque_limit")
        return None if limit is None else Strength(limit)

    def _muscle(self) -> Neuromuscular | None:
        frequency = self._figure("muscle_frequency")
        if frequency is None:
            return None
        ratio = self._figure("muscle_damping_ratio")
        return Neuromuscular(frequency, ratio, self._setting.step, many=self._many)

    def _arms(self, damping: str, stiffness: str) -> Arms:
        return Arms(*(self._or_zero(key) for key in ("arm_inertia", damping, stiffness)))

    def _grip(self, normal: Arms) -> Grip | None:
        each = [one.grips or () for one in self._all]
        if not any(each):
            return None
        return Grip(normal, self._arms("tight_damping", "tight_stiffness"), each)
