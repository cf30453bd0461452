"""Angle of a hinge from two accelerometers, one on each side of it.

Both look across the hinge: their x and z axes are perpendicular to it, their y axis is along it. At
rest both read the same vector, +g upwards. A frame that is turned by θ about +y reads
(-g·sin θ, g·cos θ), so the second is turned against the first by

    θ = atan2(B_z·A_x - B_x·A_z, A_x·B_x + A_z·B_z)

(for a hinge along -y the first argument changes its sign). In motion this still holds where both
sit on the hinge's axis, for they share its acceleration. A sensor at the distance r up its own z
axis also feels ω̇·r across and -ω²·r along, ω being its rate about y: the lever-arm terms, which
are known where the rate is measured.
"""

from __future__ import annotations

import numpy as np

from simcompare.measures import OF_PROBE, Measured, Request, _window
from simcompare.measures.heading import wrapped
from simcompare.model.trajectory import Array, Trajectory

#: samples at the end of a record where differences of differences are one-sided
EDGE = 3

SERIES = ("estimate_time", "estimate", "corrected", "true_angle")
ROLES = ("first_x", "first_z", "first_rate", "second_x", "second_z", "second_rate")
OPTIONS = (
    "still_until_s", "moving_from_s", "gravity_m_s2", "gate", "first_lever_m", "second_lever_m",
    "count",
)  # fmt: skip
AXES = dict.fromkeys(("estimate", "corrected", "true_angle"), "estimate_time")
UNITS = {
    "estimate_time": "s",
    "estimate": OF_PROBE,
    "corrected": OF_PROBE,
    "true_angle": OF_PROBE,
    "static_error": OF_PROBE,
    "moving_error": OF_PROBE,
    "corrected_error": OF_PROBE,
    "gated_error": OF_PROBE,
    "valid_fraction": "1",
}

_Plane = tuple[Array, Array]


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Angles that the sensors tell, and how far they are from the source's own joint angle.

    Args:
        trajectory: the source.
        request: its probe sees the joint's angle [rad] from where both frames coincide, its roles
            the sensors' x and z components [m/s²] and their rates about y [rad/s]. Options: the
            ends of rest and the start of motion, gravity, the levers (place of each sensor on its
            z axis, from the hinge's axis), ``gate`` (how far from g, as a part of it, a reading
            may be to be trusted) and ``count`` (evenly spaced samples of the series).

    Returns:
        ``static_error``: largest error at rest. ``moving_error``, ``corrected_error``: largest in
        motion, as read and with the lever-arm terms taken off. ``valid_fraction``: samples in
        motion at which both sensors read g to within the gate. ``gated_error``: largest error at
        those.
    """
    time_s, angle, options = trajectory.time_s, request.observed(trajectory), request.options
    first, second = (_components(trajectory, request, side) for side in ("first", "second"))
    estimate = angle_between(first, second)
    corrected = angle_between(
        *(
            without_lever_arm(felt, request.observed(trajectory, f"{side}_rate"), time_s, lever_m)
            for side, felt, lever_m in (
                ("first", first, options["first_lever_m"]),
                ("second", second, options["second_lever_m"]),
            )
        )
    )
    error, rest = wrapped(estimate - angle), wrapped(corrected - angle)
    still = time_s <= options["still_until_s"] * (1 + 1e-9)
    moving = time_s > options["moving_from_s"] * (1 + 1e-9)
    moving[-EDGE:] = False
    gravity, gate = options["gravity_m_s2"], options["gate"]
    valid = np.all([np.abs(np.hypot(*f) - gravity) < gate * gravity for f in (first, second)], 0)
    taken = _window.evenly(len(time_s), options["count"])
    return Measured(
        values={
            "static_error": _window.largest(error[still]),
            "moving_error": _window.largest(error[moving]),
            "corrected_error": _window.largest(rest[moving]),
            "gated_error": _window.largest(error[moving & valid]),
            "valid_fraction": float(valid[moving].mean()) if moving.any() else None,
        },
        series={
            "estimate_time": time_s[taken],
            "estimate": estimate[taken],
            "corrected": corrected[taken],
            "true_angle": angle[taken],
        },
    )


def angle_between(first: _Plane, second: _Plane) -> Array:
    """Angle about +y (n,) [rad] by which the second frame is turned against the first.

    Args:
        first: x and z components (n,) that the first sensor reads.
        second: those that the second reads, of the same vector.
    """
    (a_x, a_z), (b_x, b_z) = first, second
    return np.asarray(np.arctan2(b_z * a_x - b_x * a_z, a_x * b_x + a_z * b_z), dtype=float)


def without_lever_arm(felt: _Plane, rate: Array, time_s: Array, lever_m: float) -> _Plane:
    """What a sensor would read on the axis: its reading less ω̇·r across and -ω²·r along z."""
    change = np.gradient(rate, time_s, edge_order=2) if len(time_s) > 2 else np.zeros_like(rate)
    return felt[0] - change * lever_m, felt[1] + rate**2 * lever_m


def _components(trajectory: Trajectory, request: Request, side: str) -> _Plane:
    return request.observed(trajectory, f"{side}_x"), request.observed(trajectory, f"{side}_z")
