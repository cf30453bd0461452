"""Where the uncertainty of a fit of bounces comes from.

A fit is near its minimum linear in the data and in the means of the priors. When the mean of a
prior with the uncertainty u moves by one u, the estimates move by C·e/u, where C is their
covariance and e picks the unknown; the rest of C is due to the data. Between laws the squared
distances from their mean are added (law of total variance).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from simcompare import units
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.model_selection import Choice
from simcompare.fitting.bounces.unknowns import SPEED, base, slope
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_budget import DATA, LAW, Budget

#: weight of a law below which it adds nothing
_LEAST = 1e-4
#: a law -> value of a quantity and its slopes to the internal numbers (p,)
Quantity = Callable[[Fit], tuple[float, Array]]


def budgets(choice: Choice) -> tuple[Budget, ...]:
    """The budget of every quantity that is told of a fit.

    Args:
        choice: the closed forms with their weights.
    """
    best = choice.best
    rivals = [(one.fit, one.weight) for one in choice.candidates[1:] if one.weight > _LEAST]
    weight = 1.0 - sum(weight for _, weight in rivals)
    return tuple(
        _budget(name, [(best, weight), *rivals], quantity) for name, quantity in _told(best)
    )


def _told(best: Fit) -> Iterator[tuple[str, Quantity]]:
    if "restitution" in best.found:
        yield "restitution", lambda fit: fit.restitution_with_slopes(best.speeds_m_s[1])
    for name in best.found:
        finite = math.isfinite(best.values[best.names.index(name)])
        if base(name) in ("drop_height_m", SPEED) and finite:
            yield name, _unknown(name)


def _unknown(name: str) -> Quantity:
    def quantity(fit: Fit) -> tuple[float, Array]:
        k = fit.names.index(name)
        value = float(fit.values[k])
        return value, np.eye(len(fit.x))[k] / slope(name, value)

    return quantity


def _budget(name: str, laws: Sequence[tuple[Fit, float]], quantity: Quantity) -> Budget:
    able = [(fit, weight) for fit, weight in laws if _has(fit, name)]
    total = sum(weight for _, weight in able)
    parts: dict[str, float] = {}
    means = []
    for fit, weight in able:
        value, slopes = quantity(fit)
        means.append((value, weight / total))
        for source, variance in _variances(fit, slopes):
            parts[source] = parts.get(source, 0.0) + weight / total * variance
    mean = sum(value * weight for value, weight in means)
    if len(able) > 1:
        parts[LAW] = sum(weight * (value - mean) ** 2 for value, weight in means)
    whole = sum(parts.values())
    shares = {source: part / whole for source, part in parts.items()} if whole > 0 else {}
    return Budget(name, math.sqrt(whole), units.unit_of(base(name)), shares)


def _has(fit: Fit, name: str) -> bool:
    return name in fit.names and math.isfinite(fit.values[fit.names.index(name)])


def _variances(fit: Fit, slopes: Array) -> Iterator[tuple[str, float]]:
    """Source -> what it adds to the variance of a quantity."""
    index, _, u = fit.problem.prior_rows
    lean = fit.internal_covariance @ slopes
    own = (lean[index] / u) ** 2
    yield DATA, max(float(slopes @ lean - own.sum()), 0.0)
    yield from zip((fit.names[k] for k in index), own.tolist(), strict=True)
