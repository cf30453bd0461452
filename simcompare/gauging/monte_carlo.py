"""Numbers of a Monte Carlo result, each with the standard error of its own trials.

The propagation is repeated with other seeds. The mean of what the repetitions say is held against
the reference, and its standard error is their standard deviation over √(number of repetitions).
That holds for the ends of shortest intervals as well, which scatter more than quantiles do.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from simcompare.gauging.check import Check
from simcompare.statistics.distributions import Distribution
from simcompare.statistics.joint import Correlation
from simcompare.statistics.monte_carlo import Model, propagate

#: the first of every example; chance is the same each time
SEED = 2026
#: of each repetition, and how many there are
TRIALS, REPETITIONS = 200_000, 25

#: mean of the repetitions, and its standard error
Told: TypeAlias = tuple[float, float]


@dataclass(frozen=True)
class Repeated:
    """What the repetitions say.

    Attributes:
        estimate: mean of the trials.
        u: their standard deviation.
        shortest: low and high end of the shortest interval.
        symmetric: low and high end of the symmetric interval.
        probability: of both.
    """

    estimate: Told
    u: Told
    shortest: tuple[Told, Told]
    symmetric: tuple[Told, Told]
    probability: float


def repeated(
    model: Model,
    inputs: Mapping[str, Distribution],
    *,
    probability: float = 0.95,
    correlation: Correlation | None = None,
) -> Repeated:
    """Propagates the inputs with one seed after the other."""
    runs = [
        propagate(
            model,
            inputs,
            seed=SEED + k,
            trials=TRIALS,
            probability=probability,
            correlation=correlation,
        )
        for k in range(REPETITIONS)
    ]
    told = np.array([(one.estimate, one.u, *one.shortest, *one.symmetric) for one in runs])
    errors = told.std(axis=0, ddof=1) / math.sqrt(REPETITIONS)
    pairs = [(float(mean), float(error)) for mean, error in zip(told.mean(0), errors, strict=True)]
    return Repeated(
        pairs[0], pairs[1], (pairs[2], pairs[3]), (pairs[4], pairs[5]), probability
    )  # fmt: skip


def estimate(found: Repeated, reference: str, unit: str) -> Check:
    """The mean of the trials."""
    return _check(_named("Monte Carlo", unit), reference, found.estimate)


def uncertainty(found: Repeated, reference: str, unit: str) -> Check:
    """The standard deviation of the trials."""
    return _check(_named("Monte Carlo, u", unit), reference, found.u)


def interval(
    found: Repeated, low: str | None, high: str | None, unit: str, *, shortest: bool = False
) -> Iterator[Check]:
    """Both ends of a coverage interval; one at which the quantity itself ends is left out."""
    kind = "shortest" if shortest else "symmetric"
    ends = found.shortest if shortest else found.symmetric
    for reference, end, name in ((low, ends[0], "low"), (high, ends[1], "high")):
        if reference is not None:
            quantity = _named(f"{kind} {100 * found.probability:g} %, {name}", unit)
            yield _check(quantity, reference, end)


def _check(quantity: str, reference: str, told: Told) -> Check:
    return Check(quantity, reference, told[0], standard_error=told[1])


def _named(quantity: str, unit: str) -> str:
    """A quantity with its unit; "1" is none."""
    return quantity if unit == "1" else f"{quantity} ({unit})"
