"""Energy of a vehicle that drives straight ahead: what its drives give, and where it is found."""

from __future__ import annotations

import numpy as np

from simcompare.measures import Measured, Request
from simcompare.model.trajectory import Array, Trajectory

SIDES = ("left", "right")

ROLES = (
    *(f"{side}_{part}" for side in SIDES for part in ("distance", "angle", "torque")),
    "sliding_load",
)
OPTIONS = (
    "body_mass_kg",
    "wheel_mass_kg",
    "wheel_inertia_kg_m2",
    "armature_kg_m2",
    "axle_friction_N_m",
    "axle_damping_N_m_s_rad",
    "sliding_friction",
    "share",
)
UNITS = {"drive_work": "J", "kinetic_gain": "J", "dissipated": "J", "energy_imbalance": "1"}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Work of the drives against the gain of kinetic energy and what friction takes.

    All from positions and angles, and from the second sample to the last but one, where rates are
    central differences. Tyres are taken to roll; what they lose by sliding shows as imbalance.

    Args:
        trajectory: the source.
        request: its probe sees how far the body has come, its roles how far the wheels have come
            and turned, their torques, and the load [N] of what slides along under the body. Its
            options: masses and inertias of the body, of a wheel, and of a wheel's drive as the
            wheel feels it (armature); friction and viscous damping of a wheel's axle; the friction
            of what slides along; and the share of both sides together, 1, or 0.5 where both sides
            are one wheel.

    Returns:
        ``drive_work``, ``kinetic_gain``, ``dissipated``, and ``energy_imbalance``: the part of the
        work that is found nowhere, ``None`` where there is no work or are too few samples.
    """
    options = request.options
    body = request.observed(trajectory)
    if len(body) < 4:
        return Measured(values=dict.fromkeys(UNITS))
    work = lost = 0.0
    kinetic = _kinetic(trajectory.time_s, body, options["body_mass_kg"])
    spinning_kg_m2 = options["wheel_inertia_kg_m2"] + options["armature_kg_m2"]
    for side in SIDES:
        angle, torque, distance = (
            request.observed(trajectory, f"{side}_{part}")
            for part in ("angle", "torque", "distance")
        )
        work += options["share"] * _along(torque[1:-1], angle[1:-1])
        for coordinate, inertia in (
            (distance, options["wheel_mass_kg"]), (angle, spinning_kg_m2)
        ):  # fmt: skip
            kinetic += options["share"] * _kinetic(trajectory.time_s, coordinate, inertia)
        damping = options["axle_damping_N_m_s_rad"] * _rate(trajectory.time_s, angle)
        lost += options["share"] * _along(damping, angle[1:-1])
        path = np.abs(np.diff(angle[1:-1])).sum()
        lost += options["share"] * options["axle_friction_N_m"] * float(path)
    load = options["sliding_friction"] * request.observed(trajectory, "sliding_load")
    lost += abs(_along(load[1:-1], body[1:-1]))
    gain = float(kinetic[-1] - kinetic[0])
    return Measured(
        values={
            "drive_work": work,
            "kinetic_gain": gain,
            "dissipated": lost,
            "energy_imbalance": (work - gain - lost) / work if work else None,
        }
    )


def _rate(time_s: Array, values: Array) -> Array:
    """Central differences at all samples but the first and the last."""
    return np.asarray((values[2:] - values[:-2]) / (time_s[2:] - time_s[:-2]), dtype=float)


def _kinetic(time_s: Array, values: Array, inertia: float) -> Array:
    return np.asarray(0.5 * inertia * _rate(time_s, values) ** 2, dtype=float)


def _along(effort: Array, coordinate: Array) -> float:
    """Integral of an effort over a coordinate by the trapezoidal rule."""
    return float(np.trapezoid(effort, coordinate))
