"""Period of the free pendulum at large angles, over that at small ones."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from simcompare.gauging import scenario_values
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.scenarios.pendulum import reference

_EXACT = {10.0: "1.00190718814", 90.0: "1.18034059902", 170.0: "2.43936271967"}
#: the quarter period is sought between these parts of the small period, for all angles above
_FROM, _TO = 0.2, 0.7


def _checks() -> Iterator[Check]:
    for angle_deg, exact in _EXACT.items():
        yield Check(f"released at {angle_deg:g}°", exact, _period_ratio(angle_deg))


def _period_ratio(angle_deg: float) -> float:
    """Four times the time to the first pass through the middle, over the small period."""
    from scipy.optimize import brentq

    values = scenario_values.of(
        "pendulum", start_angle_rad=math.radians(angle_deg), damping_N_m_s_rad=0.0,
        friction_N_m=0.0,
    )  # fmt: skip
    small_s = 2 * math.pi * math.sqrt(values["length_m"] / values["gravity_m_s2"])

    def angle(time_s: float) -> float:
        return float(reference.motion(values, np.array([time_s]))[0][0])

    return 4 * float(brentq(angle, _FROM * small_s, _TO * small_s, xtol=1e-13)) / small_s


EXAMPLE = Example(
    "Pendulum: period at a large angle over that at a small one",
    "Complete elliptic integral, T/T0 = 2·K(sin²(a/2))/π (Landau and Lifshitz, Mechanics, §11);"
    " computed with mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
