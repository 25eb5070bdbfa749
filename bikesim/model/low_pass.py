"""Low-pass filter for a sampled signal."""

from bikesim.errors import InputError
from bikesim.model.real import Real


class LowPass:
    """A Butterworth low pass of one signal, or one of each rig, sampled with a fixed period.

    Bilinear, in second-order sections; starts at rest at the first value it is given.
    """

    def __init__(self, cutoff: float, order: int, period: float, key: str) -> None:
        """`cutoff` [rad/s] at -3 dB, below the Nyquist frequency of `period` [s]; `key` is the
        setting that a message names.
        """
        from scipy.signal import butter, sosfilt_zi

        nyquist = 3.141592653589793 / period
        if cutoff >= nyquist:
            raise InputError(
                f"{key} = {cutoff} rad/s: must be below {nyquist:.6g} rad/s, "
                f"half the sampling frequency at a period of {period} s"
            )
        sections = butter(order, cutoff / nyquist, output="sos")
        self._sections = [tuple(row) for row in sections.tolist()]
        self._rest = [tuple(row) for row in sosfilt_zi(sections).tolist()]
        self._state: list[tuple[Real, Real]] | None = None

    def __call__(self, value: Real) -> Real:
        """The filtered value at this sample."""
        if self._state is None:
            self._state = [(z0 * value, z1 * value) for z0, z1 in self._rest]
        state = self._state
        for i, (b0, b1, b2, _, a1, a2) in enumerate(self._sections):
            z0, z1 = state[i]
            out = b0 * value + z0
            state[i] = (b1 * value - a1 * out + z1, b2 * value - a2 * out)
            value = out
        return value
