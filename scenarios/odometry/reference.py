"""The robot whose servos hold its wheels at given rates: two first-order lags, and where it goes.

With v the speed of the axle's middle, where the centre of mass is, ω the yaw rate, c the servos'
gain, g_L and g_R their goals, r the radius, W the track, and wheels that roll without slip:

    M·dv/dt = c·(g_L + g_R - 2v/r)/r                   M = m + 2J/r²
    I·dω/dt = c·(g_R - g_L - W·ω/r)·W/(2r)             I = I_z + J·W²/(2r²)
    dx/dt = v·cos ψ,  dy/dt = v·sin ψ,  dψ/dt = ω

(Newton and Euler for the whole robot in the plane.) So v follows r·(g_L + g_R)/2 with the time
constant T_v = M·r²/(2c), and ω follows r·(g_R - g_L)/W with T_ω = 2·I·r²/(c·W²). On a straight
piece of a goal, u(t) = u_0 + s·t, the response is closed,

    y(t) = u_0 + s·(t - T) + (y_0 - u_0 + s·T)·exp(-t/T)

and so is its integral. Only the place needs a quadrature, by Gauss on short pieces; a goal that is
curved (a sine) is taken by the polynomial through the same points. A mark ahead of the axle, of one
gram, is left out of m and I_z as far as it shifts the centre of mass.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.model.signals import Signal
from simcompare.model.trajectory import Array
from simcompare.scenarios.body_signals import Vehicle
from simcompare.scenarios.linear_response import Pieces, edges_of

#: longest piece in time constants: errors below 1e-13
LONGEST_IN_LAGS = 2.0
#: mass of the mark whose place is surveyed [kg], and its moment of inertia [kg·m²]
MARK_KG, MARK_KG_M2 = 0.001, 1e-6


@dataclass(frozen=True)
class Robot:
    """The robot's constants.

    Attributes:
        radius_m: r.
        track_m: W.
        speed_lag_s: T_v.
        turn_lag_s: T_ω.
    """

    radius_m: float
    track_m: float
    speed_lag_s: float
    turn_lag_s: float


def robot_of(p: Mapping[str, float]) -> Robot:
    """The robot of a scenario's parameters."""
    r, track, wheel, caster = (
        p[k] for k in ("wheel_radius_m", "track_m", "wheel_mass_kg", "caster_mass_kg")
    )
    spin = 2 * wheel * r**2 / 3
    mass = p["body_mass_kg"] + 2 * wheel + 2 * caster + MARK_KG + 2 * spin / r**2
    gain = mass * r**2 / (2 * p["lag_s"])
    yaw = p["body_yaw_inertia_kg_m2"] + 2 * (spin + wheel * (track / 2) ** 2)
    yaw += 2 * caster * (1e-4 + p["caster_m"] ** 2) + MARK_KG_M2
    inertia = yaw + spin * track**2 / (2 * r**2)
    return Robot(r, track, p["lag_s"], 2 * inertia * r**2 / (gain * track**2))


def reference(
    parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
) -> dict[str, Array]:
    """Place and heading of the robot and its mark, and the angles of its wheels.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s], increasing.
        inputs: signals of ``left_rate`` and ``right_rate`` [rad/s].
    """
    robot = robot_of(parameters)
    goals = (inputs["left_rate"], inputs["right_rate"])
    x, y, heading, speed, yaw_rate, way = driven(parameters, robot, time_s, goals)
    vehicle = Vehicle(x, y, heading, speed, yaw_rate)
    signals = vehicle.body("chassis", 0.0, 0.0, robot.radius_m)
    signals |= vehicle.body("mark", parameters["mark_ahead_m"], 0.0, robot.radius_m)
    turned_by = heading - parameters["start_heading_rad"]
    for side, half in (("left", -robot.track_m / 2), ("right", robot.track_m / 2)):
        signals[f"{side}.angle_rad"] = (way + half * turned_by) / robot.radius_m
        signals[f"{side}.rate_rad_s"] = (speed + half * yaw_rate) / robot.radius_m
    return signals


def driven(
    parameters: Mapping[str, float], robot: Robot, time_s: Array, goals: Sequence[Signal]
) -> tuple[Array, ...]:
    """x, y, heading, speed, yaw rate and way of the axle's middle at the given times, (n,) each."""
    r, track = robot.radius_m, robot.track_m
    first, second = parameters["start_left_rate_rad_s"], parameters["start_right_rate_rad_s"]
    longest_s = LONGEST_IN_LAGS * min(robot.speed_lag_s, robot.turn_lag_s)
    edges, at = edges_of(time_s, goals, longest_s)
    pieces = Pieces(edges)
    left, right = (goal.at(pieces.inside.ravel()).reshape(pieces.inside.shape) for goal in goals)
    speed, speed_at = pieces.lagged(
        r * (left + right) / 2, robot.speed_lag_s, r * (first + second) / 2
    )
    turn, turn_at = pieces.lagged(
        r * (right - left) / track, robot.turn_lag_s, r * (second - first) / track
    )
    heading, heading_at = pieces.integral(turn, parameters["start_heading_rad"])
    _, x = pieces.integral(speed * np.cos(heading), parameters["start_x_m"])
    _, y = pieces.integral(speed * np.sin(heading), parameters["start_y_m"])
    _, way = pieces.integral(speed, 0.0)
    return tuple(values[at] for values in (x, y, heading_at, speed_at, turn_at, way))
