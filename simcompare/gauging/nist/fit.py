"""Fits one of NIST's problems as this program fits everywhere.

Far from the answer, as fits of signals do: by the trust region of scipy's ``least_squares`` with
each unknown in its size. Near it, as fits of bounces do: by :mod:`least_squares` of this program,
whose Jacobian gives the standard deviations. The residuals are divided by their own standard
deviation, as that of a repeated measurement is, so they are fitted again with the one found.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from simcompare.gauging.nist.files import Problem
from simcompare.gauging.nist.models import Model
from simcompare.model.trajectory import Array
from simcompare.statistics import least_squares

#: a fit ends when the next step would lower chi squared by less than this part: at rounding
_ENOUGH = 1e-20
#: damping of the first step near the answer
_LITTLE = 1e-9
#: what stands for a residual that is no number, far away from the answer
_FAR = 1e10
_REPEATS = 3


@dataclass(frozen=True)
class Fit:
    """Values of the parameters (p,) and their standard deviations (p,)."""

    values: Array
    deviations: Array


def fitted(model: Model, problem: Problem, start: Array) -> Fit:
    """Least squares from one start."""
    free = len(problem.response) - len(start)
    unit = float(np.std(problem.response))
    values = _approached(_residuals(model, problem, unit), start)
    no_bound = np.full(len(start), math.inf)
    for _ in range(_REPEATS):
        found = least_squares.solve(
            _residuals(model, problem, unit), values[None, :], -no_bound, no_bound, np.abs(values),
            enough=_ENOUGH, damping=_LITTLE,
        )  # fmt: skip
        values, left = found.x[0], float(found.chi2[0])
        covariance = least_squares.covariance_of(found.jacobian[0]) * left / free
        unit *= math.sqrt(left / free)
    return Fit(values, np.sqrt(np.diag(covariance)))


def _residuals(model: Model, problem: Problem, unit: float) -> Callable[[Array], Array]:
    def residuals(x: Array) -> Array:
        with np.errstate(all="ignore"):  # far away, models grow beyond all numbers
            return np.asarray((model(x, problem.predictors) - problem.response) / unit)

    return residuals


def _approached(residuals: Callable[[Array], Array], start: Array) -> Array:
    from scipy.optimize import least_squares as trust_region

    def finite(x: Array) -> Array:
        return np.nan_to_num(residuals(x), nan=_FAR, posinf=_FAR, neginf=-_FAR)

    with np.errstate(all="ignore"):
        found = trust_region(
            finite, start, x_scale=np.abs(start), xtol=1e-14, ftol=1e-14, gtol=1e-14, max_nfev=2000
        )
    return np.asarray(found.x, dtype=float)
