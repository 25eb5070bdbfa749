"""A rig that plays back what another one measured: for replays, and to prove the seam."""

from collections.abc import Sequence

from bikesim.model.haptic import BicycleState
from bikesim.rig.base import RigFinished, RigInfo, Sample


class PlaybackRig:
    """Gives recorded samples tick by tick; torques have no effect on them. See `Rig`."""

    def __init__(self, info: RigInfo, samples: Sequence[Sample]) -> None:
        self.info = info
        self._samples = iter(samples)
        self.commanded: list[float] = []

    def read(self) -> Sample:
        """The next recorded sample; RigFinished after the last."""
        try:
            return next(self._samples)
        except StopIteration:
            raise RigFinished("end of the recording") from None

    def command(self, torque: float) -> float:
        """Kept in `commanded` [N m]."""
        self.commanded.append(torque)
        return torque

    def show(self, bicycle: BicycleState) -> None:
        """Nobody looks."""

    def telemetry(self) -> tuple[float, ...]:
        """Nothing of its own."""
        return ()

    def wait(self) -> None:
        """The next sample is there already."""

    def close(self) -> None:
        """Nothing moves."""
