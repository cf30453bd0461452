"""Where the uncertainty of a fit of bounces comes from.

The uncertainty itself is that which is told: over all laws, with a drag that cannot be below 0. A
fit is near its minimum linear in the means of the priors: when that of a prior with the uncertainty
u moves by one u, the estimates move by C·e/u, where C is their covariance and e picks the unknown.
Between laws that tell the quantity the squared distances from their mean are added (law of total
variance). The rest is due to the data; of a terminal speed it also holds that some laws have no
drag.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from simcompare import units
from simcompare.fitting.bounces.averaging import Averaged, Share
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.model_selection import Choice
from simcompare.fitting.bounces.unknowns import SPEED, base, slope
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_parts import DATA, LAW, Budget

#: a law -> value of a quantity and its slopes to the internal numbers (p,)
Quantity = Callable[[Fit], tuple[float, Array]]


def budgets(choice: Choice, told: Averaged) -> tuple[Budget, ...]:
    """The budget of every quantity that is told of a fit.

    Args:
        choice: the closed forms.
        told: what they say together.
    """
    found = []
    for name, quantity in _quantities(choice.best):
        fast = choice.best.speeds_m_s[1]
        at_speed = name == "restitution"
        u = told.restitution_at(fast)[1] if at_speed else told.unknown(name).u
        if math.isfinite(u) and u > 0:
            found.append(_budget(name, u, told.shares, quantity))
    return tuple(found)


def _quantities(best: Fit) -> Iterator[tuple[str, Quantity]]:
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


def _budget(name: str, u: float, laws: Sequence[Share], quantity: Quantity) -> Budget:
    able = [law for law in laws if _has(law.fit, name)]
    total = sum(law.weight for law in able)
    parts: dict[str, float] = {}
    means = []
    for law in able:
        value, slopes = quantity(law.fit)
        weight = law.weight / total
        means.append((value, weight))
        for source, variance in _of_priors(law.fit, slopes):
            parts[source] = parts.get(source, 0.0) + weight * variance
    mean = sum(value * weight for value, weight in means)
    if len(able) > 1:
        parts[LAW] = sum(weight * (value - mean) ** 2 for value, weight in means)
    found = sum(parts.values())
    data = max(u**2 - found, 0.0)
    whole = found + data
    shares = {source: part / whole for source, part in {DATA: data, **parts}.items()}
    return Budget(name, u, units.unit_of(base(name)), shares)


def _has(fit: Fit, name: str) -> bool:
    return name in fit.names and math.isfinite(fit.values[fit.names.index(name)])


def _of_priors(fit: Fit, slopes: Array) -> Iterator[tuple[str, float]]:
    """Unknown with a prior -> what it adds to the variance of a quantity."""
    index, _, u = fit.problem.prior_rows
    own = (fit.internal_covariance[index] @ slopes / u) ** 2
    yield from zip((fit.names[k] for k in index), own.tolist(), strict=True)
