"""How the internal numbers of a fitted closed form are distributed, as draws.

Near its minimum χ² is a parabola, so the numbers are normally distributed. A drag below 0 is none:
only the part above 0 counts. Where the minimum lies at drag 0, the parabola's own vertex lies
below, and what is left of it above 0 says how strong a drag may still be.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.unknowns import SPEED, base
from simcompare.model.trajectory import Array
from simcompare.statistics import least_squares

#: draws of each law, a power of two
DRAWS = 1024

#: part below drag 0 that changes nothing
_TAIL = 1e-4


@dataclass(frozen=True)
class Distribution:
    """A normal distribution, of which only what lies above drag 0 counts.

    Attributes:
        mean: vertex of the parabola (p,).
        covariance: of the numbers, uncut (p, p).
        drag: which number is the drag, ``None`` if none is.
        gain: by how much χ² falls from the fit to the vertex.
    """

    mean: Array
    covariance: Array
    drag: int | None
    gain: float

    @property
    def part(self) -> float:
        """The part that counts."""
        from scipy import special

        return 1.0 if self.drag is None else float(special.ndtr(-self._least))

    @property
    def is_cut(self) -> bool:
        """Whether a part does not count that matters."""
        return self.part < 1 - _TAIL

    @property
    def _least(self) -> float:
        """Where drag 0 lies, in standard uncertainties from the vertex."""
        assert self.drag is not None
        return float(-self.mean[self.drag] / np.sqrt(self.covariance[self.drag, self.drag]))

    def draws(self) -> Array:
        """Numbers that fill the distribution evenly, always the same (N, p)."""
        count = len(self.mean)
        order = [k for k in range(count) if k != self.drag]
        order = order if self.drag is None else [self.drag, *order]
        u = np.sqrt(np.diag(self.covariance))[order]
        safe = np.where(u > 0, u, 1.0)
        part = self.covariance[np.ix_(order, order)] / np.outer(safe, safe)
        root = np.linalg.cholesky(part + np.diag(np.where(u > 0, 1e-10, 1.0)))
        normal = _normal(count).copy()
        if self.drag is not None:
            normal[:, 0] = _above(normal[:, 0], self._least)
        found = np.empty_like(normal)
        found[:, order] = self.mean[order] + normal @ root.T * u
        return found


def of_fit(fit: Fit) -> Distribution:
    """The distribution of the internal numbers of a fit, as wide as its own scatter asks."""
    drag = next((k for k, name in enumerate(fit.names) if base(name) == SPEED), None)
    if drag is None or fit.names[drag] not in fit.at_bound:
        return Distribution(fit.x, fit.internal_covariance, drag, 0.0)
    residuals, size = fit.problem.residuals, fit.problem.size
    jacobian = least_squares.jacobian_of(residuals, fit.x[None, :], size)[0] / size
    covariance = least_squares.covariance_of(jacobian)
    slope = jacobian.T @ residuals(fit.x)
    step = -covariance @ slope
    return Distribution(fit.x + step, covariance, drag, float(-slope @ step))


@cache
def _normal(count: int) -> Array:
    from scipy import special
    from scipy.stats import qmc

    even = qmc.Sobol(count, scramble=True, seed=0).random(DRAWS)
    return np.asarray(special.ndtri(np.clip(even, 1e-9, 1 - 1e-9)))


def _above(normal: Array, least: float) -> Array:
    """The same numbers moved so that they follow the part of the normal law above ``least``."""
    from scipy import special

    return np.asarray(-special.ndtri(special.ndtr(-normal) * special.ndtr(-least)))
