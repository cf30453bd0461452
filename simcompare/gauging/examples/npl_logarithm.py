"""NPL DEM-ES-011, 9.2: the logarithm of a rectangular quantity, where the first order fails."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.model.trajectory import Array
from simcompare.statistics.budget import budget
from simcompare.statistics.distributions import rectangular
from simcompare.statistics.monte_carlo import propagate

_INPUTS = {"x": rectangular(0.1, 1.1)}


def _traced(x: Number) -> Number:
    import GTC

    return GTC.log(x)


def _logarithm(x: Array) -> Array:
    return np.asarray(np.log(x))


def _checks() -> Iterator[Check]:
    known = budget(_traced, _INPUTS)
    yield Check("first order", "-0.511", known.estimate)
    yield Check("first order, u", "0.481", known.u)
    yield Check("first order, 95 %, high", "0.432", known.interval[1])
    found = propagate(_logarithm, _INPUTS, seed=monte_carlo.SEED, trials=monte_carlo.TRIALS)
    yield monte_carlo.estimate(found, "-0.665", "1")
    yield monte_carlo.uncertainty(found, "0.606", "1")
    yield from monte_carlo.interval(found, "-1.895", "0.095", "1", shortest=True)


EXAMPLE = Example(
    "y = ln x with x rectangular from 0.1 to 1.1",
    "NPL report DEM-ES-011, table 9.2.",
    _checks,
)
