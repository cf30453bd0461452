"""The smoother of Rauch, Tung and Striebel: every state, told by all measurements, also later ones.

A filter knows the past alone. Backwards through its beliefs, from the last one on,

    C = P·Fᵀ·P₊⁻¹        x ← x + C·(x' - x₊)        P ← P + C·(P' - P₊)·Cᵀ

where x₊, P₊ were predicted for the next instant and x', P' are what is known of it in the end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simcompare.estimation.kalman import Filtered
from simcompare.model.trajectory import Array


@dataclass(frozen=True, eq=False)
class Smoothed:
    """States told by all measurements.

    Attributes:
        means: (n, k).
        covariances: (n, k, k).
    """

    means: Array
    covariances: Array

    @property
    def uncertainties(self) -> Array:
        """Standard uncertainties of the states (n, k)."""
        return np.sqrt(np.diagonal(self.covariances, axis1=1, axis2=2))


def smooth(filtered: Filtered) -> Smoothed:
    """What all measurements say of every instant."""
    means, covariances = filtered.means.copy(), filtered.covariances.copy()
    for i in range(len(means) - 2, -1, -1):
        after = filtered.predicted_covariances[i + 1]
        gain = np.linalg.solve(after, filtered.transitions[i + 1] @ filtered.covariances[i]).T
        means[i] += gain @ (means[i + 1] - filtered.predicted_means[i + 1])
        covariances[i] += gain @ (covariances[i + 1] - after) @ gain.T
    return Smoothed(means, covariances)
