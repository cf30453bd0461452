"""What all closed forms say together, each by its weight.

Which law holds is not known, so it belongs to the uncertainty (K. P. Burnham and D. R. Anderson,
Model Selection and Multimodel Inference, 2nd ed., Springer 2002, ch. 4): every quantity has the
distribution that mixes those of the laws by their Akaike weights, and its mean, standard deviation
and 2.5 % and 97.5 % quantiles are told. A law without drag says 1/v_t² = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.likelihood import COVERAGE, Fit
from simcompare.fitting.bounces.model_selection import Choice
from simcompare.fitting.bounces.unknowns import SPEED, base
from simcompare.model.trajectory import Array

#: draws of each law (a power of two), and the weight below which a law is left out
DRAWS, _LEAST = 1024, 1e-4
#: ends of a 95 % interval
_ENDS = (0.025, 0.975)

#: a law with draws of its internal numbers (N, p) -> a quantity of each (N,)
Quantity = Callable[[Fit, Array], Array]


@dataclass(frozen=True)
class Told:
    """A quantity: mean, standard uncertainty and 95 % interval."""

    value: float
    u: float
    low: float
    high: float


@dataclass(frozen=True)
class Share:
    """A law, its weight, and draws from the distribution of its internal numbers (N, p)."""

    fit: Fit
    weight: float
    draws: Array = field(repr=False, compare=False)


@dataclass(frozen=True)
class Averaged:
    """What all laws say together.

    Attributes:
        shares: the laws with a weight, best first.
    """

    shares: tuple[Share, ...]

    @property
    def best(self) -> Fit:
        """Fit of the law with the greatest weight."""
        return self.shares[0].fit

    def restitution_at(self, speed_m_s: float) -> tuple[float, float, float, float]:
        """Effective restitution at that speed: mean, standard uncertainty, ends of its 95 %."""
        if len(self.shares) == 1:
            value, u = self.best.restitution_at(speed_m_s)
            return value, u, value - COVERAGE * u, value + COVERAGE * u
        found = self.mixed(lambda fit, x: _restitution(fit, x, speed_m_s))
        return found.value, found.u, found.low, found.high

    def mixed(self, quantity: Quantity) -> Told:
        """A quantity over all laws."""
        values = np.concatenate([quantity(one.fit, one.draws) for one in self.shares])
        weights = np.repeat([one.weight for one in self.shares], len(self.shares[0].draws))
        return _told(values, weights)


def averaged(choice: Choice) -> Averaged:
    """The laws of a choice with their weights; one law alone stays as it is."""
    able = [one for one in choice.candidates if one.weight > _LEAST] or [choice.candidates[0]]
    total = sum(one.weight for one in able) or 1.0
    ordered = sorted(able, key=lambda one: -one.weight)
    shares = (Share(one.fit, one.weight / total, _draws(one.fit)) for one in ordered)
    return Averaged(tuple(shares))


def _draws(fit: Fit) -> Array:
    """Draws from the normal distribution of the internal numbers, none with a drag below 0."""
    drag = [k for k, name in enumerate(fit.names) if base(name) == SPEED]
    order = [*drag, *(k for k in range(len(fit.x)) if k not in drag)]
    u = np.sqrt(np.diag(fit.internal_covariance))[order]
    safe = np.where(u > 0, u, 1.0)
    part = fit.internal_covariance[np.ix_(order, order)] / np.outer(safe, safe)
    root = np.linalg.cholesky(part + np.diag(np.where(u > 0, 1e-12, 1.0)))
    normal = _normal(len(order))
    if drag and u[0] > 0:
        normal[:, 0] = _above(normal[:, 0], -fit.x[drag[0]] / u[0])
    found = np.empty_like(normal)
    found[:, order] = fit.x[order] + normal @ root.T * u
    return found


def _normal(count: int) -> Array:
    """Standard normal numbers that fill the space evenly, always the same (N, count)."""
    from scipy import stats
    from scipy.stats import qmc

    even = qmc.Sobol(count, scramble=True, seed=0).random(DRAWS)
    return np.asarray(stats.norm.ppf(np.clip(even, 1e-9, 1 - 1e-9)))


def _above(normal: Array, least: float) -> Array:
    """The same numbers moved so that they follow the part of the normal law above ``least``."""
    from scipy import stats

    return np.asarray(stats.norm.isf(stats.norm.sf(normal) * stats.norm.sf(least)))


def _restitution(fit: Fit, x: Array, speed_m_s: float) -> Array:
    model = bounce_models.model_of(fit.model)
    return bounce_models.restitution_at(model, fit.problem.values(x, 0), np.array(speed_m_s))


def _told(values: Array, weights: Array) -> Told:
    weights = weights / weights.sum()
    mean = float(weights @ values)
    u = math.sqrt(float(weights @ (values - mean) ** 2))
    order = np.argsort(values)
    places = np.cumsum(weights[order]) - weights[order] / 2
    low, high = np.interp(_ENDS, places, values[order])
    return Told(mean, u, float(low), float(high))
