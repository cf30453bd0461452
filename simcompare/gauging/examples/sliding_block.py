"""A block on a plane of 20° with Coulomb friction 0.2."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from simcompare.gauging import scenario_values
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.scenarios.sliding_block import reference

_PLANE = {"incline_rad": math.radians(20.0), "friction": 0.2}


def _checks() -> Iterator[Check]:
    down = scenario_values.of("sliding_block", start_speed_m_s=0.0, **_PLANE)
    speed = reference.motion(down, np.array([1.0]))[1]
    yield Check("slides down (m/s²)", "1.51102451", float(speed[0]))
    up = scenario_values.of("sliding_block", start_speed_m_s=-1.5, **_PLANE)
    way = reference.motion(up, np.linspace(0.0, 0.5, 500_001))[0]
    yield Check("pushed up at 1.5 m/s, stops after (m)", "0.216466077", float(-way.min()))


EXAMPLE = Example(
    "Block on a plane of 20°, friction 0.2",
    "Coulomb's law: g·(sin a - f·cos a), and v²/2 over g·(sin a + f·cos a); computed with mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
