"""Table 1: eigenvalues and eigenvectors of M, and of the simulator's mass matrix."""

import numpy as np
from numpy.typing import NDArray

from bikesim.model.bicycle import Bicycle
from bikesim.model.law import Law
from bikesim.model.simulator import handlebar_inertia, simulator_mass_matrix
from bikesim.report.paper.claims import Claim, agrees

_PRINTED_LARGER, _PRINTED_SMALLER = "80.88397687", "0.23108501173"  # [SR13, Table 1]


def table1(bicycle: Bicycle) -> list[Claim]:
    """The claims of Table 1, for the benchmark bicycle."""
    M = bicycle.matrices.M
    smaller, larger = np.linalg.eigvalsh(M)
    return [
        _printed("Table 1: larger eigenvalue λ1 of M [kg m²]", _PRINTED_LARGER, larger),
        _printed("Table 1: smaller eigenvalue λ2 of M [kg m²]", _PRINTED_SMALLER, smaller),
        _eigenvectors(M),
        _simulator_eigenvectors(bicycle),
    ]


def eigenvectors(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit eigenvectors as columns, that of the larger eigenvalue first, shape (2, 2).

    The sign is such that the larger component of each is positive.
    """
    values, vectors = np.linalg.eig(matrix)
    vectors = vectors[:, np.argsort(-values)]
    largest = vectors[np.abs(vectors).argmax(axis=0), [0, 1]]
    return vectors * np.sign(largest)


def _printed(claim: str, printed: str, ours: float) -> Claim:
    return Claim(claim, printed, float(ours), agrees(ours, printed))


def _eigenvectors(M: NDArray[np.float64]) -> Claim:
    """One sign changed makes the pair skew by sin 2θ, whichever of the four components it is."""
    first, second = eigenvectors(M).T
    wrong = second * [-1, 1]
    skew = float(first @ wrong)
    value = np.linalg.eigvalsh(M)[0]
    residual = float(np.linalg.norm(M @ wrong - value * wrong))
    return Claim(
        "Table 1: eigenvectors of M, as printed",
        f"{_pair(np.abs(first))}, {_pair(np.abs(second))} in size, one sign wrong",
        f"{_pair(first)}, {_pair(second)}",
        holds=residual < 1e-3,
        note="Misprint: eigenvectors of a symmetric M are orthogonal, so one of the four "
        "components is negative. With a sign wrong, whichever it is, v1·v2 = "
        f"±{abs(skew):.4f} instead of {abs(first @ second):.0g}, and |M v - λ v| = "
        f"{residual:.2f} kg m² instead of 0.",
    )


def _simulator_eigenvectors(bicycle: Bicycle) -> Claim:
    M = bicycle.matrices.M
    inertia = handlebar_inertia(bicycle, Law.PAPER)
    first, second = eigenvectors(simulator_mass_matrix(bicycle, Law.PAPER, inertia)).T
    apart = float(np.abs(first - eigenvectors(M)[:, 0]).max())
    return Claim(
        "Table 1: first eigenvector of M_sim is that of M",
        "identical",
        f"{_pair(first)}, {_pair(second)}",
        holds=apart < 1e-12,
        note=f"I = λ2; the first differs from M's by {apart:.0e}. The second is pure steer.",
    )


def _pair(vector: NDArray[np.float64]) -> str:
    return f"({vector[0]:.6f}, {vector[1]:.6f})".replace("-0.000000", "0.000000")
