"""Coverage factors where bounded sources are a part of u, by Monte Carlo (JCGM 101)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.statistics import budget, monte_carlo
from simcompare.statistics.distributions import normal, rectangular, student_t

#: draws that tell a factor to 0.005
_TRIALS = 200_000
#: degrees of freedom from which on Student's t is the normal distribution to 0.001 of a factor
_MANY = 2000.0


def factor(
    unbounded: float, degrees: float, bounded: Sequence[float], probability: float = 0.95
) -> float:
    """How many times the combined standard uncertainty holds a share of all values.

    1.65 where one rectangular source does all of it, 1.96 where a normal one does, more where few
    readings told that.

    Args:
        unbounded: standard uncertainty of all that is normal.
        degrees: degrees of freedom of this.
        bounded: standard uncertainties of independent rectangular sources.
        probability: the share.
    """
    seen = [one for one in bounded if one > 0]
    if not seen:
        return budget.coverage_factor(degrees, probability)
    inputs = {f"x{i}": rectangular(-(3**0.5) * one, 3**0.5 * one) for i, one in enumerate(seen)}
    if unbounded > 0:
        told = degrees < _MANY
        inputs["n"] = student_t(0.0, unbounded, degrees) if told else normal(0.0, unbounded)
    found = monte_carlo.propagate(
        _sum, inputs, seed=0, trials=_TRIALS, probability=probability
    )  # fmt: skip
    low, high = found.symmetric
    return float((high - low) / 2 / np.sqrt(unbounded**2 + np.sum(np.square(seen))))


def _sum(**drawn: Array) -> Array:
    return np.asarray(sum(drawn.values()), dtype=float)
