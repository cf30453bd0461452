"""Numbers of a Monte Carlo result, each with what it may be off by chance."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging.check import Check
from simcompare.statistics.monte_carlo import MonteCarlo

#: of every example; chance is the same each time
SEED = 2026
TRIALS = 1_000_000
#: how far chance may put a number off, in parts of u: shortest intervals slide to and fro
CHANCE, SLIDES = 0.01, 0.03


def estimate(found: MonteCarlo, published: str, unit: str) -> Check:
    """The mean of the trials."""
    return Check(_named("Monte Carlo", unit), published, found.estimate, CHANCE * found.u)


def uncertainty(found: MonteCarlo, published: str, unit: str) -> Check:
    """The standard deviation of the trials."""
    return Check(_named("Monte Carlo, u", unit), published, found.u, CHANCE * found.u)


def interval(
    found: MonteCarlo, low: str | None, high: str | None, unit: str, *, shortest: bool = False
) -> Iterator[Check]:
    """Both ends of a coverage interval; one that is not published is left out."""
    kind = "shortest" if shortest else "symmetric"
    chance = (SLIDES if shortest else CHANCE) * found.u
    ends = found.shortest if shortest else found.symmetric
    for published, end, name in ((low, ends[0], "low"), (high, ends[1], "high")):
        if published is not None:
            quantity = _named(f"{kind} {100 * found.probability:g} %, {name}", unit)
            yield Check(quantity, published, end, chance)


def _named(quantity: str, unit: str) -> str:
    """A quantity with its unit; "1" is none."""
    return quantity if unit == "1" else f"{quantity} ({unit})"
