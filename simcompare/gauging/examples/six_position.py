"""Six-position calibration of an accelerometer: the uncertainty that its noise leaves."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.hardware.sensors import six_position
from simcompare.hardware.sensors.calibrated import Readings
from simcompare.hardware.sensors.calibration import Taken
from simcompare.statistics.distributions import fixed

#: noise of a sample [m/s²], samples of a position, local g [m/s²]; levelled perfectly
_NOISE, _SAMPLES, _GRAVITY = 0.05, 100, 9.81


def _checks() -> Iterator[Check]:
    means = _GRAVITY * np.array(list(six_position.POSITIONS.values()))
    u = np.full(means.shape, _NOISE / math.sqrt(_SAMPLES))
    found = six_position.calibrate(
        Readings(tuple(six_position.POSITIONS), means, u),
        gravity=Taken(fixed(_GRAVITY)),
        tilt=Taken(fixed(0.0)),
    )
    yield Check("sensitivity, u (1e-4)", "3.60401010", 1e4 * float(found.u_sensitivity[0, 0]))
    yield Check("cross-axis term, u (1e-4)", "3.60401010", 1e4 * float(found.u_sensitivity[0, 1]))
    yield Check("offset, u (mm/s²)", "2.04124145", 1e3 * float(found.u_offset[0]))


EXAMPLE = Example(
    "Six-position calibration: noise of 0.05 m/s², 100 samples in each position",
    "Least squares by hand: σ/(√N·√2·g) for each term of S, σ/√(6N) for O.",
    _checks,
    kind="exact",
    closed_form=True,
)
