"""High-order integration of the robot in a curve, driven by two geared motors at their voltages.

The torque of each wheel, less all friction on its axle, is that of ``robot_motor``, linear in the
wheel's rate; the equations of the robot in the plane are those of ``robot_turn``. The rotors add to
the inertia of the wheels. Source: these two; the tests hold the equations against both of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from scipy.integrate import solve_ivp

from simcompare.model.trajectory import Array
from simcompare.scenarios.robot_motor.reference import Drive
from simcompare.scenarios.robot_turn.reference import (
    LONGEST_STEP_S,
    TOLERANCE,
    signals_of,
    yaw_inertia_kg_m2,
)

#: side -> where it is, in halves of the track to the left
_SIDES = {"left": 1.0, "right": -1.0}


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the three bodies, angles of both wheels, what the motors take and give.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].
    """
    motion = integrated(parameters, time_s)
    signals = signals_of(parameters, motion)
    k, ratio = parameters["torque_constant_N_m_A"], parameters["gear_ratio"]
    for side in _SIDES:
        voltage = np.full(len(time_s), parameters[f"{side}_voltage_V"])
        rate = signals[f"{side}.rate_rad_s"]
        current = (voltage - k * ratio * rate) / parameters["resistance_Ohm"]
        signals[f"{side}_motor.voltage_V"] = voltage
        signals[f"{side}_motor.current_A"] = current
        signals[f"{side}_motor.torque_N_m"] = parameters["efficiency"] * ratio * k * current
    return signals


def integrated(parameters: Mapping[str, float], time_s: Array) -> Array:
    """x, y, heading, speed, yaw rate and the angles of both wheels at the given times (7, n)."""
    p = parameters
    r, half = p["wheel_radius_m"], p["track_m"] / 2
    drives = {
        side: Drive.of({**p, "voltage_V": p[f"{side}_voltage_V"], "caster_friction": 0.0})
        for side in _SIDES
    }
    wheel_inertia = p["wheel_mass_kg"] * r**2 / 2 + drives["left"].armature_kg_m2
    mass = p["body_mass_kg"] + 2 * p["wheel_mass_kg"] + 2 * wheel_inertia / r**2
    inertia = yaw_inertia_kg_m2(p) + 2 * wheel_inertia * half**2 / r**2
    behind = p["body_mass_kg"] * p["center_behind_m"]

    def motion(_: float, state: Array) -> Array:
        heading, v, w = state[2:5].tolist()
        rates = {side: (v - place * w * half) / r for side, place in _SIDES.items()}
        forces = {
            side: (one.stall_N_m - one.damping_N_m_s_rad * rates[side]) / r
            for side, one in drives.items()
        }
        growth = (sum(forces.values()) - behind * w**2) / mass
        turning = ((forces["right"] - forces["left"]) * half + behind * v * w) / inertia
        way = (v * math.cos(heading), v * math.sin(heading))
        return np.array((*way, w, growth, turning, *rates.values()))

    solution = solve_ivp(
        motion, (0.0, float(time_s[-1])), np.zeros(7), "DOP853", rtol=TOLERANCE, atol=TOLERANCE,
        max_step=LONGEST_STEP_S, dense_output=True,
    )  # fmt: skip
    assert solution.sol is not None
    return np.asarray(solution.sol(time_s), dtype=float)
