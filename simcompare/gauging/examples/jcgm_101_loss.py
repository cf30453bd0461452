"""JCGM 101:2008, 9.4: comparison loss of a microwave power meter, y = x1² + x2²."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from simcompare.gauging import monte_carlo
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.statistics.distributions import normal
from simcompare.statistics.monte_carlo import propagate

_U = 0.005
#: x1, r, and in 1e-6: mean, u, and the ends of the shortest interval where they are known
_CASES = (
    (0.0, 0.0, "50.0", "50.0", "150"),
    (0.010, 0.0, "150.0", "111.8", "367"),
    (0.050, 0.0, "2550.0", "502.5", None),
    (0.0, 0.9, "50.0", "67.3", None),
    (0.010, 0.9, "150.0", "120.5", None),
    (0.050, 0.9, "2550.0", "504.5", None),
)


def _loss(x1: Number, x2: Number) -> Number:
    return 1e6 * (x1 * x1 + x2 * x2)


def _checks() -> Iterator[Check]:
    for x1, r, mean, u, high in _CASES:
        found = propagate(
            _loss, {"x1": normal(x1, _U), "x2": normal(0.0, _U)}, seed=monte_carlo.SEED,
            trials=monte_carlo.TRIALS, correlation={("x1", "x2"): r} if r else None,
        )  # fmt: skip
        for check in (
            monte_carlo.estimate(found, mean, "1e-6"),
            monte_carlo.uncertainty(found, u, "1e-6"),
            *monte_carlo.interval(found, None, high, "1e-6", shortest=True),
        ):
            yield replace(check, quantity=f"x1 = {x1:g}, r = {r:g}: {check.quantity}")


EXAMPLE = Example(
    "JCGM 101 9.4, comparison loss: a quantity that cannot be below 0",
    "Inputs of JCGM 101:2008, 9.4. Exact moments of the model: mean x1² + 2u², variance"
    " 4·x1²·u² + 4·u⁴·(1 + r²); intervals recomputed independently with 4 million trials.",
    _checks,
)
