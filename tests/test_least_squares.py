"""Least squares near an answer in a narrow valley: three exponentials that nearly make up."""

from __future__ import annotations

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.statistics import least_squares

X = np.arange(24) * 0.05
TRUTH = np.array([0.0951, 1.0, 0.8607, 3.0, 1.5576, 5.0])
NOISE = 1e-5
OBSERVED = sum(a * np.exp(-b * X) for a, b in TRUTH.reshape(3, 2)) + np.random.default_rng(
    1
).normal(0, NOISE, len(X))
FREE = np.full(6, np.inf)


def residuals(b: Array) -> Array:
    parts = b.reshape(*b.shape[:-1], 3, 2, 1)
    model = np.sum(parts[..., 0, :] * np.exp(-parts[..., 1, :] * X), axis=-2)
    return np.asarray((model - OBSERVED) / NOISE)


def spread(**how: float) -> float:
    """How far answers from two starts near the answer are apart, in standard uncertainties."""
    starts = TRUTH * (1 + np.outer([1e-3, -1e-3], [1, -1, 1, 1, -1, 1]))
    found = least_squares.solve(residuals, starts, -FREE, FREE, TRUTH, **how)
    u = np.sqrt(np.diag(least_squares.covariance_of(found.jacobian[0])))
    return float(np.abs(np.diff(found.x, axis=0) / u).max())


def test_usual_fits_end_well_within_the_uncertainty() -> None:
    assert spread() < 1e-2


def test_a_bold_fit_goes_on_to_rounding() -> None:
    # the usual one stops ten times farther away, where nobody else could tell a difference
    assert spread(enough=1e-20, damping=1e-9) < 3e-7 < spread()
