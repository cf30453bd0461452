"""How estimates scatter: fits to simulated repeats."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.fitting.bounces.likelihood import Fit, minimise
from simcompare.fitting.bounces.unknowns import external
from simcompare.model.trajectory import Array

DRAWS = 200
#: fits that are solved side by side
_TOGETHER = 50


@dataclass(frozen=True)
class Bootstrap:
    """Estimates of many repeats.

    Attributes:
        names: the unknowns.
        draws: estimates (B, p); an infinite terminal speed means no drag.
        u: standard deviation of each, NaN where some are infinite (p,).
        low: 2.5 % quantiles (p,).
        high: 97.5 % quantiles (p,).
        bias: median less the fit's estimate (p,).
        failed: fits that did not converge and were left out.
        seed: of the generator.
    """

    names: tuple[str, ...]
    draws: Array
    u: Array
    low: Array
    high: Array
    bias: Array
    failed: int
    seed: int


def parametric(fit: Fit, draws: int = DRAWS, seed: int = 0) -> Bootstrap:
    """Fits to data simulated with the fitted parameters and the measurements' noise.

    The noise is as wide as the fit found it; the means of priors are drawn anew as well.
    """
    generator = np.random.default_rng(seed)
    problem = fit.problem
    data = problem.predicted(fit.x) + problem.noise(generator, draws)
    index, _, u = problem.prior_rows
    mean = fit.x[index] + u * generator.standard_normal((draws, len(index)))
    found, fine = [], []
    for first in range(0, draws, _TOGETHER):
        part = slice(first, first + _TOGETHER)
        start = np.tile(fit.x, (len(data[part]), 1))
        best = minimise(problem, start, data[part], mean[part])
        found.append(best.x)
        fine.append(best.converged)
    return _summary(fit, np.concatenate(found), np.concatenate(fine), seed)


def _summary(fit: Fit, x: Array, fine: NDArray[np.bool_], seed: int) -> Bootstrap:
    whole = np.column_stack([external(name, x[fine][:, k]) for k, name in enumerate(fit.names)])
    finite = np.isfinite(whole).all(axis=0)
    safe = np.where(np.isfinite(whole), whole, 0.0)
    low, high, middle = (_quantile(whole, q) for q in (0.025, 0.975, 0.5))
    with np.errstate(invalid="ignore"):
        bias = middle - fit.values
    u = np.where(finite, safe.std(axis=0, ddof=1), np.nan)
    return Bootstrap(fit.names, whole, u, low, high, bias, int(np.sum(~fine)), seed)


def _quantile(draws: Array, q: float) -> Array:
    """Quantile by the nearest draw, so that an infinite one stays infinite."""
    return np.asarray(np.quantile(draws, q, axis=0, method="nearest"))
