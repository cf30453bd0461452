"""High-order integration of the robot on two wheels that are driven by different torques.

With v the speed of the axle's middle, ω the yaw rate and b the distance of the body's centre of
mass behind the axle, wheels that roll without slip, and nothing that resists at the caster:

    (m + 2J/r²)·dv/dt = (τ_R + τ_L)/r - m_b·b·ω²
    (I_z + J·W²/(2r²))·dω/dt = (τ_R - τ_L)·W/(2r) + m_b·b·v·ω

The loads follow from the balances of moments about the axle and about the way ahead, h being the
height of the body's centre of mass and φ' the rates of the wheels, whose spin turns with the robot:

    L·N_c = b·m_b·g + m_b·h·(dv/dt + b·ω²) + (2·m_w·r + 2J/r)·dv/dt
    (N_R - N_L)·W/2 = m_b·h·(v·ω - b·dω/dt) + 2·m_w·r·v·ω + J·(φ'_R + φ'_L)·ω

I_z is about the vertical through the axle's middle, wheels included. Source: Newton and Euler for
the whole robot in the plane; the tests hold it against an integration of the three bodies in space,
with their joints and contacts as constraints.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.integrate import solve_ivp

from simcompare.errors import InputError
from simcompare.model.rotations import multiply, quaternions_of
from simcompare.model.trajectory import Array
from simcompare.scenarios.body_signals import Vehicle

#: of the integration, relative and absolute: a thousandth of what the tests ask for
TOLERANCE = 1e-12
#: longest step of the integration [s]; between steps the polynomial of order 7 is used
LONGEST_STEP_S = 0.01


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the three bodies, angles of both wheels and their torques.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].
    """
    motion = integrated(parameters, time_s)
    signals = signals_of(parameters, motion)
    for side in ("left", "right"):
        torque = np.full(len(time_s), parameters[f"{side}_torque_N_m"])
        signals[f"{side}_motor.torque_N_m"] = torque
    return {**signals, **_loads(parameters, motion[3], motion[4])}


def signals_of(parameters: Mapping[str, float], motion: Array) -> dict[str, Array]:
    """Motion of the three bodies and angles of both wheels.

    Args:
        parameters: those of the scenario, SI.
        motion: x, y, heading, speed, yaw rate and the angles of both wheels (7, n).
    """
    x, y, heading, speed, yaw_rate, left, right = motion
    count, r = len(x), parameters["wheel_radius_m"]
    zero, vehicle = np.zeros(count), Vehicle(x, y, heading, speed, yaw_rate)
    behind_m, height_m = parameters["center_behind_m"], parameters["center_height_m"]
    signals = vehicle.body("chassis", -behind_m, 0.0, height_m)
    for side, sign, angle in (("left", 1, left), ("right", -1, right)):
        half = sign * parameters["track_m"] / 2
        rate = (speed - yaw_rate * half) / r
        wheel = f"{side}_wheel"
        signals |= vehicle.body(wheel, 0.0, half, r)
        rolled = quaternions_of(np.column_stack((zero, angle, zero)))
        signals[f"{wheel}.orientation_wxyz"] = multiply(vehicle.orientation_wxyz, rolled)
        signals[f"{wheel}.rate_rad_s"] += rate[:, None] * vehicle.aside
        signals[f"{side}.angle_rad"], signals[f"{side}.rate_rad_s"] = angle, rate
    return signals


def _loads(p: Mapping[str, float], speed: Array, yaw_rate: Array) -> dict[str, Array]:
    """Normal forces of the three contacts.

    Raises:
        InputError: the tyres cannot hold the robot in this curve.
    """
    body_mass, wheel_mass = p["body_mass_kg"], p["wheel_mass_kg"]
    r, b, height = p["wheel_radius_m"], p["center_behind_m"], p["center_height_m"]
    wheel_inertia, mass = wheel_mass * r**2 / 2, body_mass + 2 * wheel_mass
    growth, turning = accelerations(p, speed, yaw_rate)
    # accelerations of the body's centre of mass, ahead and to the left
    ahead, aside = growth + b * yaw_rate**2, speed * yaw_rate - b * turning
    caster = (
        b * body_mass * p["gravity_m_s2"]
        + body_mass * height * ahead
        + 2 * (wheel_mass * r + wheel_inertia / r) * growth
    ) / p["caster_behind_m"]
    rolling_over = (
        body_mass * height * aside + 2 * (wheel_mass * r + wheel_inertia / r) * speed * yaw_rate
    )
    both, shifted = mass * p["gravity_m_s2"] - caster, rolling_over / p["track_m"]
    traction = np.hypot(
        body_mass * ahead + 2 * wheel_mass * growth,
        body_mass * aside + 2 * wheel_mass * speed * yaw_rate,
    )
    if np.any(traction > p["tyre_friction"] * both) or np.any(np.abs(shifted) > both / 2):
        fault = "the tyres cannot hold the robot in this curve: it takes less torque, or less time"
        raise InputError("parameters of the robot", [fault])
    return {
        "caster.normal_force_N": caster,
        "left_tyre.normal_force_N": both / 2 - shifted,
        "right_tyre.normal_force_N": both / 2 + shifted,
    }


def integrated(parameters: Mapping[str, float], time_s: Array) -> Array:
    """x, y, heading, speed, yaw rate and the angles of both wheels at the given times (7, n)."""
    r, half = parameters["wheel_radius_m"], parameters["track_m"] / 2

    def motion(_: float, state: Array) -> Array:
        _, _, heading, v, w, _, _ = state
        growth, turning = accelerations(parameters, v, w)
        way = (v * np.cos(heading), v * np.sin(heading))
        return np.array((*way, w, growth, turning, (v - w * half) / r, (v + w * half) / r))

    solution = solve_ivp(
        motion, (0.0, float(time_s[-1])), np.zeros(7), "DOP853", rtol=TOLERANCE, atol=TOLERANCE,
        max_step=LONGEST_STEP_S, dense_output=True,
    )  # fmt: skip
    assert solution.sol is not None
    return np.asarray(solution.sol(time_s), dtype=float)


def accelerations(p: Mapping[str, float], speed: Array, yaw_rate: Array) -> tuple[Array, Array]:
    """dv/dt [m/s²] and dω/dt [rad/s²] at any speeds and yaw rates."""
    r, track = p["wheel_radius_m"], p["track_m"]
    wheel_inertia = p["wheel_mass_kg"] * r**2 / 2
    felt_mass = p["body_mass_kg"] + 2 * p["wheel_mass_kg"] + 2 * wheel_inertia / r**2
    felt_inertia = yaw_inertia_kg_m2(p) + wheel_inertia * track**2 / (2 * r**2)
    left, right = p["left_torque_N_m"], p["right_torque_N_m"]
    offset = p["body_mass_kg"] * p["center_behind_m"]
    turning = (right - left) * track / (2 * r) + offset * speed * yaw_rate
    return ((right + left) / r - offset * yaw_rate**2) / felt_mass, turning / felt_inertia


def yaw_inertia_kg_m2(parameters: Mapping[str, float]) -> float:
    """I_z of the whole robot about the vertical through the middle of its axle, by Steiner."""
    wheel_mass, r = parameters["wheel_mass_kg"], parameters["wheel_radius_m"]
    body = parameters["body_mass_kg"] * parameters["center_behind_m"] ** 2
    own = wheel_mass * (3 * r**2 + parameters["wheel_width_m"] ** 2) / 12
    wheels = 2 * (own + wheel_mass * (parameters["track_m"] / 2) ** 2)
    return parameters["body_yaw_inertia_kg_m2"] + body + wheels
