"""The standard atmosphere near sea level, as a pressure sensor uses it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.scenarios.barometer import reference

#: height over which the slope at sea level is taken [m]
_STEP_M = 0.01


def _checks() -> Iterator[Check]:
    exponent = reference.WEIGHT_K_M / reference.LAPSE_K_M
    yield Check("exponent", "5.255785959", exponent)
    yield Check("its inverse", "0.1902665002", 1 / exponent)
    low, high = reference.pressure(np.array([-_STEP_M, _STEP_M]))
    yield Check("height over pressure at sea level (m/Pa)", "-0.0832436", float(
        2 * _STEP_M / (high - low)))  # fmt: skip


EXAMPLE = Example(
    "Standard atmosphere: pressure over height",
    "ISO 2533:1975 with the molar gas constant of the SI: g·M/(R·L), and R·T/(g·M·p) for the slope;"
    " computed with mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
