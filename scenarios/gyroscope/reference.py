"""Closed form of the turntable: a torque of straight lines, integrated exactly.

All that turns has the inertia J = J_table + J_mass + m·ρ², so ω̇ = τ/J. The torque is a straight
line between its corners, so the rate is a parabola and the angle a cubic there. What is bolted to
the table at the radius ρ feels the specific force (-ω²·ρ, ω̇·ρ, g) in the table's frame: the
acceleration of its place, ω̇ × ρ + ω × (ω × ρ), less that of free fall.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.instants import piece_at

#: corners of the torque, in times of one flank, and its values over that of speeding up
CORNERS = (0.0, 1.0, 4.0, 5.0, 8.0, 9.0, 15.0, 16.0)
VALUES = (0.0, 1.0, 1.0, 0.0, 0.0, -1.0, -1.0, 0.0)
#: flanks of full torque that give the peak rate: 3 and two halves
FLANKS_TO_PEAK = 4.0


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the table and what its sensors read at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].

    Returns:
        ``axis.angle_rad`` and ``axis.rate_rad_s`` (n,), and ``gyro.rate_rad_s``,
        ``accelerometer.specific_force_m_s2`` and ``load_cell.force_N`` (n, 3) in the table's frame.
    """
    acceleration, rate, angle = motion(parameters, time_s)
    radius = parameters["radius_m"]
    zero = np.zeros(len(time_s))
    gravity = np.full(len(time_s), parameters["gravity_m_s2"])
    felt = np.column_stack((-(rate**2) * radius, acceleration * radius, gravity))
    return {
        "axis.angle_rad": angle,
        "axis.rate_rad_s": rate,
        "gyro.rate_rad_s": np.column_stack((zero, zero, rate)),
        "accelerometer.specific_force_m_s2": felt,
        "load_cell.force_N": parameters["test_mass_kg"] * felt,
    }


def motion(parameters: Mapping[str, float], time_s: Array) -> tuple[Array, Array, Array]:
    """Angular acceleration [rad/s²], rate [rad/s] and angle [rad] at the given times (n,)."""
    corners = np.array(CORNERS) * parameters["flank_s"]
    peak = parameters["peak_rate_rad_s"] / (FLANKS_TO_PEAK * parameters["flank_s"])
    values = np.array(VALUES) * peak
    spans = np.diff(corners)
    slopes = np.diff(values) / spans
    rates = np.concatenate(([0.0], np.cumsum(spans * (values[1:] + values[:-1]) / 2)))
    turned = rates[:-1] * spans + values[:-1] * spans**2 / 2 + slopes * spans**3 / 6
    angles = np.concatenate(([0.0], np.cumsum(turned)))
    piece = piece_at(corners[:-1], time_s)
    t = time_s - corners[piece]
    start, slope = values[piece], slopes[piece]
    rate = rates[piece] + start * t + slope * t**2 / 2
    angle = angles[piece] + rates[piece] * t + start * t**2 / 2 + slope * t**3 / 6
    return start + slope * t, rate, angle
