"""What each haptic law keeps of the bicycle, and the handlebar inertia that it asks for."""

import numpy as np

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.whipple import Matrix


def handlebar_inertia(bicycle: Bicycle, law: Law) -> float:
    """The inertia I_δ [kg m²] about the steer axis that the law asks of the rig.

    `paper` and `off`: λ2, the smaller eigenvalue of M [SR13, Table 1]. `momentum`:
    M_δδ - M_φδ²/M_φφ, with which the simulator is the bicycle.
    """
    M = bicycle.matrices.M
    if law is Law.MOMENTUM:
        return float(M[1, 1] - M[0, 1] * M[1, 0] / M[0, 0])
    return float(np.linalg.eigvalsh(M)[0])


def simulator_mass_matrix(bicycle: Bicycle, law: Law, inertia: float) -> Matrix:
    """The 2 x 2 mass matrix of roll equation and handlebar together [kg m²].

    `inertia` is that about the rig's steer axis, I_δ. `paper`: eq. 7 of [SR13],
    [[M_φφ, 0], [M_δφ, I_δ]]. `momentum`: the same elimination of p = M_φφ φ̇ + M_φδ δ̇ gives
    [[M_φφ, M_φδ], [M_δφ, I_δ + M_δφ M_φδ / M_φφ]]. `off`: [[M_φφ, 0], [0, I_δ]].
    """
    (M_pp, M_pd), (M_dp, _) = bicycle.matrices.M
    match law:
        case Law.PAPER:
            return np.array([[M_pp, 0.0], [M_dp, inertia]])
        case Law.MOMENTUM:
            return np.array([[M_pp, M_pd], [M_dp, inertia + M_dp * M_pd / M_pp]])
        case Law.OFF:
            return np.array([[M_pp, 0.0], [0.0, inertia]])


def simulator_matrices(
    bicycle: Bicycle, law: Law, speed: float, inertia: float | None = None
) -> tuple[Matrix, Matrix, Matrix]:
    """Mass, damping and stiffness (each 2 x 2, SI) of the simulator with nobody at the bar.

    [SR13, eq. 7] at forward speed [m/s]; `inertia` [kg m²] is what the law asks for by default.
    With haptics off the second rows of damping and stiffness are zero.
    """
    if inertia is None:
        inertia = handlebar_inertia(bicycle, law)
    mass = simulator_mass_matrix(bicycle, law, inertia)
    damping = bicycle.matrices.damping(speed)
    stiffness = bicycle.matrices.stiffness(speed, bicycle.gravity)
    if law is Law.OFF:
        felt = np.array([[1.0], [0.0]])
        return mass, felt * damping, felt * stiffness
    return mass, damping, stiffness
