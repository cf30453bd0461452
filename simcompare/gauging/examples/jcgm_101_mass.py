"""JCGM 101:2008, 9.3: calibration of a mass in air."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.statistics.budget import budget
from simcompare.statistics.distributions import normal, rectangular
from simcompare.statistics.monte_carlo import propagate

_INPUTS = {
    "reference_mg": normal(100_000.0, 0.050),
    "added_mg": normal(1.234, 0.020),
    "air_kg_m3": rectangular(1.10, 1.30),
    "weight_kg_m3": rectangular(7000.0, 9000.0),
    "standard_kg_m3": rectangular(7950.0, 8050.0),
}


def _deviation(
    reference_mg: Number,
    added_mg: Number,
    air_kg_m3: Number,
    weight_kg_m3: Number,
    standard_kg_m3: Number,
) -> Number:
    buoyancy = (air_kg_m3 - 1.2) * (1 / weight_kg_m3 - 1 / standard_kg_m3)
    return (reference_mg + added_mg) * (1 + buoyancy) - 100_000.0


def _checks() -> Iterator[Check]:
    known = budget(_deviation, _INPUTS)
    yield Check("first order (mg)", "1.234", known.estimate)
    yield Check("first order, u (mg)", "0.0539", known.u)
    found = propagate(
        _deviation, _INPUTS, seed=monte_carlo.SEED, trials=2 * monte_carlo.TRIALS
    )  # fmt: skip
    yield monte_carlo.estimate(found, "1.234", "mg")
    yield monte_carlo.uncertainty(found, "0.0755", "mg")
    yield from monte_carlo.interval(found, "1.086", "1.385", "mg", shortest=True)


EXAMPLE = Example(
    "JCGM 101 9.3, calibration of a mass: the first order misses a product of two inputs",
    "Model and inputs of JCGM 101:2008, 9.3; numbers recomputed independently with 4 million"
    " trials.",
    _checks,
)
