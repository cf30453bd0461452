"""Calibration of a gyroscope on a rate table: turned about each axis at known rates, both ways.

The sensor is set up once for each axis and then turned both ways. So its axis is off that of the
table by the same two small angles at all rates about it: they do not cancel and go into the
cross-axis terms, while along the axis only their square counts. An error of the table's rate scales
all of S. The Earth turns too: up to its rate is in the offset.
"""

from __future__ import annotations

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.sensors import linear_fit
from simcompare.hardware.sensors.calibrated import About, Readings, calibration_of
from simcompare.hardware.sensors.calibration import Calibration, Taken
from simcompare.hardware.sensors.six_position import ON_A_TABLE
from simcompare.model.trajectory import Array
from simcompare.statistics.distributions import rectangular

#: rate of the Earth [rad/s]
EARTH = Taken(rectangular(-7.2921e-5, 7.2921e-5), "rectangular")
#: what a turntable with a good motor holds of its rate, part of it
A_TURNTABLE = Taken(rectangular(-1e-3, 1e-3), "a turntable, within 0.1 %, rectangular")

UNIT = "rad/s"
NOT_SEPARABLE = (
    "A rotation of the sensor in its box and cross-axis terms: what is in S is seen from the box.",
    "An error of the table's rate and the sensitivity: it scales all of S.",
    "The Earth's rate and the offset: up to 7.3e-5 rad/s of it is in O.",
    "An effect of g on the gyroscope and the offset, where each axis stood upright.",
    "Changes with temperature, and the wandering of the offset after the calibration.",
)


def calibrate(
    readings: Readings,
    rates: Array,
    scale: Taken = A_TURNTABLE,
    alignment: Taken = ON_A_TABLE,
) -> Calibration:
    """S and O of a gyroscope.

    Args:
        readings: their names are for tables alone.
        rates: at which they were read (p, 3) [rad/s], each about one axis or none.
        scale: by what part the table's rates are off, all alike.
        alignment: by which a box is off the table's axis, two angles for each axis [rad].

    Raises:
        InputError: an axis was not turned both ways, or about more than one axis at once.
    """
    _check(rates)
    u_tilt = alignment.known.u
    known = (1 - u_tilt**2) * (1 + scale.known.center) * rates
    found = linear_fit.fit(
        linear_fit.Known(known, _errors(rates, scale.known.u, u_tilt)),
        readings.means, readings.u, readings.degrees_of_freedom,
    )  # fmt: skip
    assumptions = (
        scale.assumed("rate of the table", "1", "scales all of S"),
        alignment.assumed(
            "alignment", "rad", "goes into cross-axis terms; cancels on the diagonal"
        ),
        EARTH.assumed("rate of the Earth", UNIT, "goes into the offset"),
    )
    about = About("rate-table", UNIT, NOT_SEPARABLE, assumptions, "rate of the table")
    used = np.ones(len(rates), dtype=bool)
    return calibration_of(about, found, readings, used, known, 0.0)


def _check(rates: Array) -> None:
    faults = []
    if np.any(np.sum(rates != 0, axis=1) > 1):
        faults.append("a rate is about more than one axis; turn the table about one at a time")
    for number, axis in enumerate("xyz"):
        about = rates[:, number]
        missing = [name for name, there in (("+", about > 0), ("-", about < 0)) if not there.any()]
        faults += [f"{sign}{axis} missing: turn it that way about {axis}" for sign in missing]
    if faults:
        raise InputError("rate table", faults)


def _errors(rates: Array, u_scale: float, u_tilt: float) -> dict[str, Array]:
    """Covariances (3p, 3p) of the rates that act."""
    flat, one = rates.ravel(), np.eye(3)
    tilted = np.zeros((len(flat), len(flat)))
    for axis in range(3):
        # the same two angles at every rate about this axis
        along = np.outer(one[axis], one[axis])
        spread = u_tilt**2 * (one - along) + u_tilt**4 * along
        tilted += np.kron(np.outer(rates[:, axis], rates[:, axis]), spread)
    everywhere = np.asarray(
        np.kron(np.ones((len(rates), len(rates))), EARTH.known.u**2 * one), float
    )
    return {
        "rate of the table": u_scale**2 * np.outer(flat, flat),
        "alignment": tilted,
        "rate of the Earth": everywhere,
    }
