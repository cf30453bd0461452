"""NPL DEM-ES-011, 9.2: the logarithm of a rectangular quantity, where the first order fails."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.model.trajectory import Array
from simcompare.statistics.budget import budget
from simcompare.statistics.distributions import rectangular

_INPUTS = {"x": rectangular(0.1, 1.1)}
#: by which the low end of the report is known to be off, and ours by chance
_THEIR_CHANCE = 0.004
_TRIALS = "the report has it from trials of its own; exact is ln 0.15 = −1.89712"
_EXACT = (
    "Quantiles ln(0.1 + p), and ∫ ln x dx and ∫ ln² x dx from 0.1 to 1.1; computed with mpmath. The"
    " density rises up to ln 1.1, so the shortest interval is the topmost."
)


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
    found = monte_carlo.repeated(_logarithm, _INPUTS)
    yield monte_carlo.estimate(found, "-0.665", "1")
    yield monte_carlo.uncertainty(found, "0.606", "1")
    low, high = monte_carlo.interval(found, "-1.895", "0.095", "1", shortest=True)
    yield replace(low, standard_error=0.0, allowed=_THEIR_CHANCE, remark=_TRIALS)
    yield high
    for check in _exact(found):
        yield replace(check, kind="exact", source=_EXACT)


def _exact(found: monte_carlo.Repeated) -> Iterator[Check]:
    yield monte_carlo.estimate(found, "-0.66490029", "1")
    yield monte_carlo.uncertainty(found, "0.60622670", "1")
    yield from monte_carlo.interval(found, "-1.89711998", None, "1", shortest=True)
    yield from monte_carlo.interval(found, "-2.07944154", "0.07232066", "1")


EXAMPLE = Example(
    "y = ln x with x rectangular from 0.1 to 1.1",
    "NPL report DEM-ES-011, table 9.2; read in the tests of suncal 1.7.",
    _checks,
)
