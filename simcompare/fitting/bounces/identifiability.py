"""What the data of a fit of bounces can tell about its unknowns."""

from __future__ import annotations

import numpy as np

from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.unknowns import slope
from simcompare.model.trajectory import Array
from simcompare.statistics import identifiability as statistics
from simcompare.statistics import least_squares
from simcompare.statistics.identifiability import Identifiability


def identifiability(fit: Fit) -> Identifiability:
    """What the data of a fit can tell about its unknowns, where what is assumed holds."""
    problem = fit.problem.firm
    jacobian = least_squares.jacobian_of(
        problem.residuals, fit.x[None, :], problem.size
    )[0] / problem.size  # fmt: skip
    kept = [fit.names.index(name) for name in fit.found]
    return statistics.identifiability(
        fit.found, jacobian[:, kept], slopes=_slopes(fit)[kept], u=fit.u[kept]
    )


def _slopes(fit: Fit) -> Array:
    """Derivatives of the unknowns to the internal numbers; at no drag those of 1/v_t² itself."""
    return np.array([
        1 / slope(name, float(value)) if np.isfinite(value) else -1.0
        for name, value in zip(fit.names, fit.values, strict=True)
    ])  # fmt: skip
