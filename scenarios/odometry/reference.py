"""The robot whose servos hold its wheels at given rates: two first-order lags, and where it goes.

With φ' the rates of the wheels, r their radii, W the track, M the mass and I the yaw inertia of all
without the spin of the wheels, J their spin, c the servos' gain and g their goals, wheels that roll
without slip and the centre of mass in the middle of the axle:

    A·dφ'/dt = c·(g - φ')         v = (r_L·φ'_L + r_R·φ'_R)/2,  ω = (r_R·φ'_R - r_L·φ'_L)/W
    A_LL = r_L²·(M/4 + I/W²) + J_L,  A_LR = r_L·r_R·(M/4 - I/W²),  A_RR like A_LL
    dx/dt = v·cos ψ,  dy/dt = v·sin ψ,  dψ/dt = ω

(Newton and Euler for the whole robot in the plane.) A/c is symmetric: its eigenvalues are two time
constants, and along its eigenvectors the rates follow their goals apart from each other. Of equal
wheels these are speed, T_v = (M + 2J/r²)·r²/(2c), and turn, T_ω = 2·(I + J·W²/(2r²))·r²/(c·W²). On
a straight piece of a goal, u(t) = u_0 + s·t, the response is closed,

    y(t) = u_0 + s·(t - T) + (y_0 - u_0 + s·T)·exp(-t/T)

and so is its integral. Only the place needs a quadrature, by Gauss on short pieces; a goal that is
curved (a sine) is taken by the polynomial through the same points. A mark ahead of the axle, of one
gram, is left out of M and I as far as it shifts the centre of mass.
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
        left_radius_m: r_L.
        right_radius_m: r_R.
        track_m: W.
        lags_s: both time constants, speed first where the wheels are equal.
        modes: eigenvectors in columns (2, 2), of the rates of the left and the right wheel.
    """

    left_radius_m: float
    right_radius_m: float
    track_m: float
    lags_s: tuple[float, float]
    modes: Array


def robot_of(p: Mapping[str, float], right_larger: float = 0.0) -> Robot:
    """The robot of a scenario's parameters.

    Args:
        p: parameters of the scenario.
        right_larger: by what part the radius of the right wheel is larger than the left one's.
    """
    r, track, wheel, caster = (
        p[k] for k in ("wheel_radius_m", "track_m", "wheel_mass_kg", "caster_mass_kg")
    )
    radii = np.array([r, r * (1 + right_larger)])
    spins = 2 * wheel * radii**2 / 3
    mass = p["body_mass_kg"] + 2 * wheel + 2 * caster + MARK_KG
    gain = (mass * r**2 + 2 * spins[0]) / (2 * p["lag_s"])
    yaw = p["body_yaw_inertia_kg_m2"] + float(spins.sum()) + 2 * wheel * (track / 2) ** 2
    yaw += 2 * caster * (1e-4 + p["caster_m"] ** 2) + MARK_KG_M2
    felt = np.outer(radii, radii) * (mass / 4 + yaw / track**2 * np.array([[1, -1], [-1, 1]]))
    lags, modes = np.linalg.eigh((felt + np.diag(spins)) / gain)
    # the mode of speed has both rates of one sign
    order = np.argsort(-modes[0] * modes[1])
    first, second = (float(lags[k]) for k in order)
    return Robot(r, float(radii[1]), track, (first, second), modes[:, order])


def reference(
    parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
) -> dict[str, Array]:
    """Place and heading of the robot and its mark, and the angles of its wheels.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s], increasing.
        inputs: signals of ``left_rate`` and ``right_rate`` [rad/s].
    """
    return signals_of(parameters, robot_of(parameters), time_s, inputs)


def signals_of(
    parameters: Mapping[str, float], robot: Robot, time_s: Array, inputs: Mapping[str, Signal]
) -> dict[str, Array]:
    """The same for a robot whose wheels may be unequal."""
    goals = (inputs["left_rate"], inputs["right_rate"])
    x, y, heading, speed, yaw_rate, way = driven(parameters, robot, time_s, goals)
    vehicle = Vehicle(x, y, heading, speed, yaw_rate)
    signals = vehicle.body("chassis", 0.0, 0.0, robot.left_radius_m)
    signals |= vehicle.body("mark", parameters["mark_ahead_m"], 0.0, robot.left_radius_m)
    turned_by = heading - parameters["start_heading_rad"]
    half = robot.track_m / 2
    for side, sign, r in (("left", -1, robot.left_radius_m), ("right", 1, robot.right_radius_m)):
        signals[f"{side}.angle_rad"] = (way + sign * half * turned_by) / r
        signals[f"{side}.rate_rad_s"] = (speed + sign * half * yaw_rate) / r
    return signals


def driven(
    parameters: Mapping[str, float], robot: Robot, time_s: Array, goals: Sequence[Signal]
) -> tuple[Array, ...]:
    """x, y, heading, speed, yaw rate and way of the axle's middle at the given times, (n,) each."""
    first = (parameters["start_left_rate_rad_s"], parameters["start_right_rate_rad_s"])
    edges, at = edges_of(time_s, goals, LONGEST_IN_LAGS * min(robot.lags_s))
    pieces = Pieces(edges)
    wanted = np.array([g.at(pieces.inside.ravel()).reshape(pieces.inside.shape) for g in goals])
    followed = [
        pieces.lagged(np.tensordot(mode, wanted, 1), lag_s, float(mode @ first))
        for mode, lag_s in zip(robot.modes.T, robot.lags_s, strict=True)
    ]
    inside, ends = (np.array(part) for part in zip(*followed, strict=True))
    speed, turn = _of_modes(robot, inside)
    speed_at, turn_at = _of_modes(robot, ends)
    heading, heading_at = pieces.integral(turn, parameters["start_heading_rad"])
    _, x = pieces.integral(speed * np.cos(heading), parameters["start_x_m"])
    _, y = pieces.integral(speed * np.sin(heading), parameters["start_y_m"])
    _, way = pieces.integral(speed, 0.0)
    return tuple(values[at] for values in (x, y, heading_at, speed_at, turn_at, way))


def _of_modes(robot: Robot, modes: Array) -> tuple[Array, Array]:
    """Speed and yaw rate from both modes of the wheels' rates (2, …)."""
    rates = np.tensordot(robot.modes, modes, 1)
    left, right = robot.left_radius_m * rates[0], robot.right_radius_m * rates[1]
    return (left + right) / 2, (right - left) / robot.track_m
