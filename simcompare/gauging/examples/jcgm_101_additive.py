"""JCGM 101:2008, 9.2: a sum of four quantities, normal and rectangular ones."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.statistics.budget import budget
from simcompare.statistics.distributions import Distribution, normal, rectangular

_NAMES = ("x1", "x2", "x3", "x4")


def _rectangular(u: float) -> Distribution:
    return rectangular(-u * math.sqrt(3), u * math.sqrt(3))


@dataclass(frozen=True)
class _Case:
    """One clause: its inputs, exact u, U for 95 % of first order and end of the interval.

    Attributes:
        table: where u and end are published as well.
    """

    name: str
    shapes: tuple[Distribution, ...]
    u: str
    expanded: str
    end: str
    table: str = ""
    published: tuple[str, str] = ("", "")


_CASES = (
    _Case(
        "9.2.2 normal", (normal(0, 1),) * 4, "2.0000000", "3.9199280", "3.9199280",
        "table 2", ("2.0", "3.92"),
    ),
    _Case(
        "9.2.3 rectangular", (_rectangular(1),) * 4, "2.0000000", "3.9199280", "3.8794067",
        "table 3", ("2.0", "3.88"),
    ),
    _Case(
        "9.2.4 one is wider", (*(_rectangular(1),) * 3, _rectangular(10)), "10.1488916",
        "19.8914620", "17.0158141",
    ),
)  # fmt: skip


def _sum(**x: Number) -> Number:
    return sum(x.values())


def _checks() -> Iterator[Check]:
    for case in _CASES:
        for check in _of(case):
            yield replace(check, quantity=f"{case.name}: {check.quantity}")


def _of(case: _Case) -> Iterator[Check]:
    inputs = dict(zip(_NAMES, case.shapes, strict=True))
    known = budget(_sum, inputs)
    yield Check("first order, u", case.u, known.u)
    yield Check("first order, U for 95 %", case.expanded, known.expanded)
    found = monte_carlo.repeated(_sum, inputs)
    yield from _trials(found, case.u, case.end)
    if case.table:
        source = f"JCGM 101:2008, {case.table}; read in the tests of suncal 1.7."
        for check in _trials(found, *case.published):
            yield replace(check, kind="published", source=source)


def _trials(found: monte_carlo.Repeated, u: str, end: str) -> Iterator[Check]:
    yield monte_carlo.uncertainty(found, u, "1")
    yield from monte_carlo.interval(found, f"-{end}", end, "1")


EXAMPLE = Example(
    "JCGM 101 9.2, sum of four quantities",
    "Inputs of JCGM 101:2008, 9.2. u = √(sum of squares), U = 1.959964·u; ends of the rectangular"
    " sums from their distribution function, a polynomial in pieces, solved with mpmath.",
    _checks,
    kind="exact",
)
