"""Six-position calibration of an accelerometer: at rest with each axis up and down.

In a pose whose axis e points up the sensor feels g·e. Levelling is never perfect: the true vertical
is off e by two small angles in each pose, independent of the other poses. What they turn into an
axis that lies flat goes into the cross-axis terms and the offset; along e only their square counts
(1 - ε²/2). It is taken off here and its scatter is kept. g scales all of S.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.sensors import linear_fit
from simcompare.hardware.sensors.calibrated import About, Readings, calibration_of
from simcompare.hardware.sensors.calibration import Calibration, Taken
from simcompare.model.trajectory import Array
from simcompare.statistics.distributions import Distribution, rectangular

#: name of a position -> direction of "up" in the box
POSITIONS = {
    f"{sign}{axis}": factor * np.eye(3)[number]
    for number, axis in enumerate("xyz")
    for sign, factor in (("+", 1.0), ("-", -1.0))
}
#: free fall anywhere at sea level: 9.780 (equator) to 9.832 (poles) [m/s²]
SOMEWHERE = Taken(rectangular(9.780, 9.832), "anywhere at sea level (WGS 84), rectangular")
#: by which a box on a table is off the vertical, each of two tilts [rad]
ON_A_TABLE = Taken(
    rectangular(-np.radians(0.5), np.radians(0.5)), "a box on a table, within 0.5°, rectangular"
)

UNIT = "m/s**2"
NOT_SEPARABLE = (
    "A rotation of the sensor in its box and cross-axis terms: what is in S is seen from the box.",
    "The unit of g and the sensitivity: an error of g scales all of S.",
    "An odd curvature of the characteristic and the sensitivity: S is that of the chord from −g to"
    " +g, and what a bow leaves between is not in the uncertainty.",
    "Changes with temperature: S and O hold at the temperature of the calibration.",
)


def calibrate(
    readings: Readings,
    gravity: Taken = SOMEWHERE,
    tilt: Taken = ON_A_TABLE,
) -> Calibration:
    """S and O of an accelerometer.

    Args:
        readings: in positions named "+x" (x axis up), "-x" and so on, some more than once; poses
            of other names verify.
        gravity: what is known of g [m/s²].
        tilt: by which "up" is off, each of two angles in each pose [rad].

    Raises:
        InputError: a position is missing, or the readings are no accelerometer's.
    """
    used = np.array([name in POSITIONS for name in readings.names])
    _check([name for name in readings.names if name in POSITIONS])
    up = np.array([POSITIONS[name] for name in np.array(readings.names)[used]])
    g, u_tilt = gravity.known, tilt.known.u
    level = g.center * (1 - u_tilt**2)  # ε²/2 of two angles, each of variance u²
    known = linear_fit.Known(level * up, _errors(up, g, u_tilt))
    effect = "goes into cross-axis terms and offset; cancels on the diagonal"
    if readings.u is None:  # six positions cannot tell it from noise: both are in what is left
        del known.errors["levelling"]
        effect = "is part of the scatter that tells the noise, and not counted twice"
    noise = None if readings.u is None else readings.u[used]
    found = linear_fit.fit(known, readings.means[used], noise, readings.degrees_of_freedom)
    assumptions = (
        gravity.assumed("local g", UNIT, "scales all of S"),
        # several independent angles make one term: their sum is nearly normal
        replace(tilt.assumed("levelling", "rad", effect), shape="normal"),
    )
    about = About("six-position", UNIT, NOT_SEPARABLE, assumptions, "local g")
    return calibration_of(about, found, readings, used, level * up, g.center)


def nearest(mean: Array, within_rad: float = np.radians(20.0)) -> str | None:
    """The position that a reading belongs to, ``None`` where it is far from each of them."""
    up = mean / np.linalg.norm(mean)
    name = max(POSITIONS, key=lambda one: float(POSITIONS[one] @ up))
    return name if float(POSITIONS[name] @ up) >= np.cos(within_rad) else None


def _check(names: Sequence[str]) -> None:
    missing = [name for name in POSITIONS if name not in names]
    if missing:
        told = ", ".join(missing)
        raise InputError("six positions", [
            f"{told} missing; without both signs of an axis its sensitivity and offset cannot be"
            f" told apart: add a still pose with each of these axes up"
        ])  # fmt: skip


def _errors(up: Array, gravity: Distribution, u_tilt: float) -> dict[str, Array]:
    """Covariances (3p, 3p) of the known values."""
    flat, g = up.ravel(), gravity.center
    along = [np.outer(one, one) for one in up]
    tilted = [u_tilt**2 * (np.eye(3) - one) + u_tilt**4 * one for one in along]
    return {
        "local g": gravity.u**2 * np.outer(flat, flat),
        "levelling": g**2 * _diagonal(tilted),
    }


def _diagonal(blocks: Sequence[Array]) -> Array:
    """A matrix with these (3, 3) on its diagonal."""
    whole = np.zeros((3 * len(blocks), 3 * len(blocks)))
    for number, block in enumerate(blocks):
        place = slice(3 * number, 3 * number + 3)
        whole[place, place] = block
    return whole
