"""Noise of a calibration's readings where only what the fit leaves tells it.

On an axis across what acts, levelling adds to the noise; along it, only its square counts. So there
are two variances, and residuals tell both (C. R. Rao's MINQUE, 1971). Levelling only adds: that
along is never the larger one. Six positions tell it poorly where levelling is far larger than the
noise, so it is never taken as less than a part of the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array

#: least variance along, part of that across
_LEAST = 1 / 8
_NOTHING = 1e-60


@dataclass(frozen=True, eq=False)
class Told:
    """What residuals tell of the noise.

    Attributes:
        variances: of readings along what acts, and across it.
        covariance: of these two (2, 2).
        across: which readings are across it (n,), 0 or 1.
    """

    variances: Array
    covariance: Array
    across: Array

    @property
    def of_readings(self) -> Array:
        """Variance of each reading (n,)."""
        chosen = np.where(self.across == 1, self.variances[1], self.variances[0])
        return np.asarray(chosen, dtype=float)

    def degrees_of_freedom(self, gain: Array) -> Array:
        """Of the noise in each parameter that the gain makes of readings (Satterthwaite)."""
        squared = np.square(gain)
        parts = np.column_stack([squared @ (1 - self.across), squared @ self.across])
        spread = np.einsum("pi,ij,pj->p", parts, self.covariance, parts)
        return np.asarray(np.maximum(2 * (parts @ self.variances) ** 2 / spread, 1.0), dtype=float)


def told(rows: Array, readings: Array, across: Array) -> Told:
    """The two variances, from what a fit without weights leaves.

    Args:
        rows: design of the readings (n, parameters).
        readings: (n,).
        across: which of them nothing acts along (n,), 0 or 1.
    """
    free = np.eye(len(rows)) - rows @ np.linalg.pinv(rows)
    left = free @ readings
    spare = float(np.trace(free))
    groups = (1 - across, across)
    seen = np.array([[one @ np.square(free) @ other for other in groups] for one in groups])
    pooled = max(float(left @ left) / spare, _NOTHING)
    if np.linalg.cond(seen) < 1e6:
        along, flat = np.linalg.solve(seen, [one @ np.square(left) for one in groups])
        if along <= flat and flat > _NOTHING:
            variances = np.array([max(along, _LEAST * flat), flat])
            return Told(variances, _scatter(free, groups, seen, variances), across)
    both = np.full((2, 2), 2 * pooled**2 / spare)
    return Told(np.array([pooled, pooled]), both, across)


def _scatter(free: Array, groups: tuple[Array, Array], seen: Array, variances: Array) -> Array:
    """Covariance of the two variances, of normal readings."""
    whole = free @ np.diag(groups[0] * variances[0] + groups[1] * variances[1]) @ free
    squares = [[2 * one @ np.square(whole) @ other for other in groups] for one in groups]
    inverse = np.linalg.inv(seen)
    return np.asarray(inverse @ squares @ inverse.T, dtype=float)
