"""Calibration of a pressure sensor at two or more known pressures, or at two heights.

Each known pressure has its own uncertainty, from a reference beside the sensor. Two heights of a
staircase give the ratio of two pressures instead: it tells the offset, and the sensitivity
as well as the pressure below is known.
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
#: molar mass of dry air times g over the gas constant: K of air temperature a metre
_PER_M_K = 0.0289644 * 9.80665 / 8.31446
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
    return _calibration(readings, linear_fit.Known(values, errors), assumptions)


def at_heights(
    readings: Readings,
    heights_m: Sequence[float],
    below: Distribution,
    height_u_m: float,
    temperature_K: Distribution,
) -> Calibration:
    """S and O of a pressure sensor that was carried up.

    Args:
        readings: means (p, 1) [Pa], the first at the lowest height.
        heights_m: above the first one, which is 0 [m].
        below: what is known of the pressure at the lowest height [Pa].
        height_u_m: standard uncertainty of each other height [m].
        temperature_K: of the air between them [K].

    Raises:
        InputError: heights do not differ, or no noise for two readings.
    """
    height, warm = np.array(heights_m, dtype=float), temperature_K.center
    ratio = np.exp(-_PER_M_K * height / warm)
    values = below.center * ratio
    _check(readings, values[:, None])
    per_height = -values * _PER_M_K / warm
    own = np.where(height == 0, 0.0, height_u_m)
    per_kelvin = values * _PER_M_K * height / warm**2
    known = linear_fit.Known(
        values[:, None],
        {
            "pressure below": below.u**2 * np.outer(ratio, ratio),
            "heights": np.diag((per_height * own) ** 2),
            "air temperature": temperature_K.u**2 * np.outer(per_kelvin, per_kelvin),
        },
    )
    assumptions = (
        Assumption("pressure below", below.center, below.u, UNIT, "as stated", "scales S"),
        Assumption("heights", float(height.max()), height_u_m, "m", "as stated", "moves S and O"),
        Assumption("air temperature", warm, temperature_K.u, "K", "as stated", "moves S and O"),
    )
    return _calibration(readings, known, assumptions)


def _calibration(
    readings: Readings, known: linear_fit.Known, assumptions: tuple[Assumption, ...]
) -> Calibration:
    found = linear_fit.fit(known, readings.means, readings.u, readings.degrees_of_freedom)
    about = About("two-point", UNIT, NOT_SEPARABLE, assumptions, "")
    used = np.ones(len(known.values), dtype=bool)
    return calibration_of(about, found, readings, used, known.values, math.nan)


def _check(readings: Readings, values: np.ndarray) -> None:
    if len(np.unique(values)) < 2:
        raise InputError("two points", ["all known pressures are the same; add another one"])
    if readings.u is None and len(values) < 3:
        cure = "state the noise of a mean reading, or read at a third pressure"
        raise InputError("two points", [f"two readings cannot tell their own noise; {cure}"])
