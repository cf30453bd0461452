"""Frequency at which a seismic accelerometer has lost 3 dB."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from simcompare.gauging import scenario_values
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.scenarios.accelerometer import reference

#: damping ratio -> frequency over the natural one
_EXACT = {0.5: "1.27201965", math.sqrt(0.5): "1.00000000", 1.0: "0.6435942529"}


def _checks() -> Iterator[Check]:
    for ratio, exact in _EXACT.items():
        yield Check(f"damping ratio {ratio:.4g}", exact, _cut(ratio))


def _cut(ratio: float) -> float:
    from scipy.optimize import brentq

    values = scenario_values.of("accelerometer", damping_ratio=ratio)
    natural_Hz = values["natural_frequency_Hz"]

    def over(frequency: float) -> float:
        amplitude = np.abs(reference.response(values, np.array([frequency * natural_Hz])))
        return float(amplitude[0]) - math.sqrt(0.5)

    return float(brentq(over, 0.1, 3.0, xtol=1e-12))


EXAMPLE = Example(
    "Seismic accelerometer: where it has lost 3 dB, over its natural frequency",
    "√(1 - 2ζ² + √(4ζ⁴ - 4ζ² + 2)), where the response of the oscillator is 1/√2; computed with"
    " mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
