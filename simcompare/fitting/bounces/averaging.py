"""What all closed forms say together, each by its weight.

Which law holds is not known, so it belongs to the uncertainty (K. P. Burnham and D. R. Anderson,
Model Selection and Multimodel Inference, 2nd ed., Springer 2002, ch. 4): every quantity has the
distribution that mixes those of the laws by their Akaike weights, and its mean, standard deviation
and 2.5 % and 97.5 % quantiles are told (JCGM 101). A law without drag says 1/v_t² = 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from simcompare.fitting.bounces import bounce_models, distribution
from simcompare.fitting.bounces.hunt_crossley import REFERENCE_SPEED
from simcompare.fitting.bounces.likelihood import COVERAGE, Fit
from simcompare.fitting.bounces.model_selection import Choice
from simcompare.fitting.bounces.unknowns import BOUNDS, SPEED, base, external
from simcompare.model.trajectory import Array

#: weight below which a law is left out
_LEAST = 1e-4
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
        shares: the laws with a weight, in the order of the choice.
    """

    shares: tuple[Share, ...]

    @cached_property
    def is_normal(self) -> bool:
        """Whether one law has all the weight, and no drag that could be 0."""
        return len(self.shares) == 1 and not distribution.of_fit(self.shares[0].fit).is_cut

    def restitution_at(self, speed_m_s: float) -> tuple[float, float, float, float]:
        """Effective restitution at that speed: mean, standard uncertainty, ends of its 95 %."""
        if self.is_normal:
            value, u = self.shares[0].fit.restitution_at(speed_m_s)
            return value, u, max(value - COVERAGE * u, 0.0), min(value + COVERAGE * u, 1.0)
        found = _told(self.shares, lambda fit, x: _restitution(fit, x, speed_m_s))
        return found.value, found.u, found.low, found.high

    def unknown(self, name: str) -> Told:
        """An unknown over all laws that have it or, being without drag or slope, say it is 0.

        Args:
            name: of an unknown of the law with the greatest weight.
        """
        kind = base(name)
        if self.is_normal or (kind == SPEED and len(self.shares) == 1):
            return _own(self.shares[0].fit, name)
        if kind == "restitution":
            return Told(*self.restitution_at(REFERENCE_SPEED))
        if kind == "exponent":
            return _told(self.shares, _exponent)
        if kind == SPEED:
            return _terminal(_told(self.shares, lambda fit, x: _column(fit, x, name)))
        able = [one for one in self.shares if name in one.fit.names]
        return _told(able, lambda fit, x: _column(fit, x, name))


def averaged(choice: Choice) -> Averaged:
    """The laws of a choice with their weights."""
    able = [one for one in choice.candidates if one.weight > _LEAST]
    total = sum(one.weight for one in able)
    return Averaged(tuple(Share(one.fit, one.weight / total, _draws(one.fit)) for one in able))


def alone(fit: Fit) -> Averaged:
    """One law that nothing is averaged with."""
    return Averaged((Share(fit, 1.0, _draws(fit)),))


def _draws(fit: Fit) -> Array:
    """Draws of the internal numbers, none of which leaves the bounds."""
    found = distribution.of_fit(fit).draws()
    return np.clip(found, fit.problem.low, fit.problem.high)


def _own(fit: Fit, name: str) -> Told:
    """An unknown as the fit of its law has it, with its profile where it has one."""
    k, (least, most) = fit.names.index(name), BOUNDS[base(name)]
    low, high = fit.intervals[k]
    return Told(float(fit.values[k]), float(fit.u[k]), max(low, least), min(high, most))


def _restitution(fit: Fit, x: Array, speed_m_s: float) -> Array:
    model = bounce_models.model_of(fit.model)
    found = bounce_models.restitution_at(model, fit.problem.values(x, 0), np.array(speed_m_s))
    return np.broadcast_to(found, (len(x),))


def _exponent(fit: Fit, x: Array) -> Array:
    model = bounce_models.model_of(fit.model)
    found = bounce_models.exponent_of(model, fit.problem.values(x, 0))
    return np.broadcast_to(found, (len(x),))


def _column(fit: Fit, x: Array, name: str) -> Array:
    return x[:, fit.names.index(name)] if name in fit.names else np.zeros(len(x))


def _told(shares: Sequence[Share], quantity: Quantity) -> Told:
    values = np.concatenate([quantity(one.fit, one.draws) for one in shares])
    weights = np.repeat([one.weight / len(one.draws) for one in shares], len(shares[0].draws))
    weights /= weights.sum()
    mean = float(weights @ values)
    u = math.sqrt(float(weights @ (values - mean) ** 2))
    order = np.argsort(values)
    places = np.cumsum(weights[order]) - weights[order] / 2
    low, high = np.interp(_ENDS, places, values[order])
    return Told(mean, u, float(low), float(high))


def _terminal(drag: Told) -> Told:
    """The terminal speed of a drag 1/v_t²; without an upper end where there may be none."""
    low, value, high = (float(external(SPEED, end)) for end in (drag.high, drag.value, drag.low))
    u = drag.u * value**3 / 2 if drag.low > 0 else math.nan
    return Told(value, u, low, high)
