"""JCGM 100:2008, H.2: resistance and reactance, read together five times."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations

import numpy as np

from simcompare.gauging.check import Check
from simcompare.gauging.example import Example, Number
from simcompare.statistics.budget import Budget, budget
from simcompare.statistics.distributions import student_t

#: voltage [V], current [A] and phase [rad] of the five readings
_READ = {
    "voltage": (5.007, 4.994, 5.005, 4.990, 4.999),
    "current": (19.663e-3, 19.639e-3, 19.640e-3, 19.685e-3, 19.678e-3),
    "phase": (1.0456, 1.0438, 1.0468, 1.0428, 1.0433),
}

_ROUNDED = "the GUM goes on with rounded uncertainties and correlations"


def _resistance(voltage: Number, current: Number, phase: Number) -> Number:
    import GTC

    return voltage / current * GTC.cos(phase)


def _reactance(voltage: Number, current: Number, phase: Number) -> Number:
    import GTC

    return voltage / current * GTC.sin(phase)


def _impedance(voltage: Number, current: Number, phase: Number) -> Number:
    return voltage / current + 0 * phase


def _budget(model: Callable[..., Number]) -> Budget:
    count = len(_READ["phase"])
    means = {
        name: student_t(float(np.mean(x)), float(np.std(x, ddof=1)) / count**0.5, count - 1)
        for name, x in _READ.items()
    }
    together = dict(
        zip(
            combinations(_READ, 2),
            (float(np.corrcoef(_READ[a], _READ[b])[0, 1]) for a, b in combinations(_READ, 2)),
            strict=True,
        )
    )
    return budget(model, means, correlation=together, ensembles=[tuple(_READ)])


def _checks() -> Iterator[Check]:
    published = (
        ("R", _resistance, "127.732", "0.071"),
        ("X", _reactance, "219.847", "0.295"),
        ("Z", _impedance, "254.260", "0.236"),
    )
    for name, model, value, u in published:
        found = _budget(model)
        yield Check(f"{name} (Ω)", value, found.estimate)
        yield Check(f"{name}, u (Ω)", u, found.u, allowed=0.0005, remark=_ROUNDED)


EXAMPLE = Example(
    "GUM H.2, resistance and reactance from correlated readings",
    "JCGM 100:2008, table H.4; read in the tests of suncal 1.7.",
    _checks,
)
