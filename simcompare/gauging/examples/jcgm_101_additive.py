"""JCGM 101:2008, 9.2: a sum of four quantities, normal and rectangular ones."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.statistics.budget import budget
from simcompare.statistics.distributions import Distribution, normal, rectangular
from simcompare.statistics.monte_carlo import propagate

_NAMES = ("x1", "x2", "x3", "x4")


def _sum(**x: Number) -> Number:
    return sum(x.values())


def _rectangular(u: float) -> Distribution:
    return rectangular(-u * math.sqrt(3), u * math.sqrt(3))


def _checks() -> Iterator[Check]:
    cases = (
        ("9.2.2 normal", [normal(0, 1)] * 4, "2.00", "3.92", "3.92"),
        ("9.2.3 rectangular", [_rectangular(1)] * 4, "2.00", "3.92", "3.88"),
        ("9.2.4 one is wider", [*[_rectangular(1)] * 3, _rectangular(10)], "10.1", "19.9", "17.0"),
    )
    for name, shapes, u, first, trials in cases:
        inputs = dict(zip(_NAMES, shapes, strict=True))
        known = budget(_sum, inputs)
        found = propagate(_sum, inputs, seed=monte_carlo.SEED, trials=4 * monte_carlo.TRIALS)
        yield Check(f"{name}: first order, u", u, known.u)
        yield Check(f"{name}: first order, U for 95 %", first, known.expanded)
        for check in (
            monte_carlo.uncertainty(found, u, "1"),
            *monte_carlo.interval(found, f"-{trials}", trials, "1"),
        ):
            yield replace(check, quantity=f"{name}: {check.quantity}")


EXAMPLE = Example(
    "JCGM 101 9.2, sum of four quantities",
    "JCGM 101:2008, tables 2 to 4; recomputed independently with 4 million trials.",
    _checks,
)
