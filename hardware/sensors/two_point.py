"""Calibration of a pressure sensor at two or more known pressures.

Each known pressure has its own uncertainty, from a reference beside the sensor.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.sensors import linear_fit
from simcompare.hardware.sensors.calibrated import About, Readings, calibration_of
from simcompare.hardware.sensors.calibration import Assumption, Calibration
from simcompare.statistics.distributions import Distribution

UNIT = "Pa"
NOT_SEPARABLE = (
    "An error that all known pressures share and the offset.",
    "A curvature of the characteristic: two points tell a straight line through them.",
    "Changes with temperature: S and O hold at the temperature of the calibration.",
)


def calibrate(
    readings: Readings,
    pressures: Sequence[Distribution],
    source: str = "as stated",
) -> Calibration:
    """S and O of a pressure sensor.

    Args:
        readings: means (p, 1) [Pa]; their noise must be known where there are only two.
        pressures: what is known of each pressure [Pa], independent of each other.
        source: where that comes from.

    Raises:
        InputError: fewer than two different pressures, or no noise for two readings.
    """
    values = np.array([[one.center] for one in pressures])
    _check(readings, values)
    errors = {"known pressures": np.diag([one.u**2 for one in pressures])}
    assumptions = tuple(
        Assumption(name, one.center, one.u, UNIT, source, "moves S and O")
        for name, one in zip(readings.names, pressures, strict=True)
    )
    known = linear_fit.Known(values, errors)
    found = linear_fit.fit(known, readings.means, readings.u, readings.degrees_of_freedom)
    about = About("two-point", UNIT, NOT_SEPARABLE, assumptions, "")
    used = np.ones(len(values), dtype=bool)
    return calibration_of(about, found, readings, used, values, math.nan)


def _check(readings: Readings, values: np.ndarray) -> None:
    if len(np.unique(values)) < 2:
        raise InputError("two points", ["all known pressures are the same; add another one"])
    if readings.u is None and len(values) < 3:
        cure = "state the noise of a mean reading, or read at a third pressure"
        raise InputError("two points", [f"two readings cannot tell their own noise; {cure}"])
