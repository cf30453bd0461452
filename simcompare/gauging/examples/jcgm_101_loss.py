"""JCGM 101:2008, 9.4: comparison loss of a microwave power meter, y = x1² + x2²."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.statistics.distributions import normal

_U = 0.005
#: x1, r, and in 1e-6: mean, u, and the ends of the shortest interval; ``None`` where it begins at 0
_CASES = (
    (0.0, 0.0, "50.00000", "50.00000", None, "149.78661"),
    (0.010, 0.0, "150.00000", "111.80340", None, "366.00529"),
    (0.050, 0.0, "2550.00000", "502.49378", "1593.56967", "3548.56981"),
    (0.0, 0.9, "50.00000", "67.26812", None, "185.05646"),
    (0.010, 0.9, "150.00000", "120.51971", "12.65156", "397.47878"),
    (0.050, 0.9, "2550.00000", "504.50471", "1624.41857", "3554.68245"),
)


def _loss(x1: Number, x2: Number) -> Number:
    return 1e6 * (x1 * x1 + x2 * x2)


def _checks() -> Iterator[Check]:
    for x1, r, mean, u, low, high in _CASES:
        found = monte_carlo.repeated(
            _loss, {"x1": normal(x1, _U), "x2": normal(0.0, _U)},
            correlation={("x1", "x2"): r} if r else None,
        )  # fmt: skip
        for check in (
            monte_carlo.estimate(found, mean, "1e-6"),
            monte_carlo.uncertainty(found, u, "1e-6"),
            *monte_carlo.interval(found, low, high, "1e-6", shortest=True),
        ):
            yield replace(check, quantity=f"x1 = {x1:g}, r = {r:g}: {check.quantity}")


EXAMPLE = Example(
    "JCGM 101 9.4, comparison loss: a quantity that cannot be below 0",
    "Inputs of JCGM 101:2008, 9.4. Exact moments: mean x1² + 2u², variance 4·x1²·u² +"
    " 4·u⁴·(1 + r²). Ends: quantiles of the non-central χ² with 2 degrees of freedom for r = 0,"
    " of u²·(1.9·z1² + 0.1·z2²) by Gauss-Legendre quadrature (400 nodes) for r = 0.9.",
    _checks,
    kind="exact",
)
