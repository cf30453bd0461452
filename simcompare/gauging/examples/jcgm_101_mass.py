"""JCGM 101:2008, 9.3: calibration of a mass in air."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.statistics.budget import budget
from simcompare.statistics.distributions import normal, rectangular

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
    yield Check("first order (mg)", "1.234000", known.estimate)
    yield Check("first order, u (mg)", "0.05385165", known.u)
    found = monte_carlo.repeated(_deviation, _INPUTS)
    yield monte_carlo.estimate(found, "1.234000", "mg")
    yield monte_carlo.uncertainty(found, "0.07547974", "mg")
    yield from monte_carlo.interval(found, "1.084433", "1.383567", "mg", shortest=True)
    yield from monte_carlo.interval(found, "1.084433", "1.383567", "mg")


EXAMPLE = Example(
    "JCGM 101 9.3, calibration of a mass: the first order misses a product of two inputs",
    "Model and inputs of JCGM 101:2008, 9.3. First order √(0.05² + 0.02²); the rest by"
    " Gauss-Legendre quadrature over the densities of air, weight and standard (80 x 60 x 12"
    " nodes), with the normal distribution of the masses in closed form. Both intervals agree"
    " to 1e-7.",
    _checks,
    kind="exact",
)
