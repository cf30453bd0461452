"""A robot on two driven wheels as a filter sees it: five states, their motion, what sensors read.

The states are the place x, y of the middle of the axle, the heading θ, the speed v along it and the
turning rate ω. Two motors give the forward force and the turning moment; both are braked in
proportion to the speed, so that with λ = damping/inertia

    dx/dt = v·cos θ    dy/dt = v·sin θ    dθ/dt = ω    dv/dt = g - λ·v    dω/dt = h - λ'·ω

What the motors do not say, such as a bump or slip, is white noise of the two accelerations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.estimation.kalman import Motion
from simcompare.model.trajectory import Array

#: places of the states
X, Y, HEADING, SPEED, RATE = range(5)
#: a robot that is slower rests [m/s]
_RESTS_M_S = 1e-6


@dataclass(frozen=True)
class Robot:
    """Numbers of the robot.

    Attributes:
        radius_m: of the wheels.
        track_m: distance of the wheels.
        inertia_kg: M_e, the mass with what wheels and rotors add.
        turning_inertia_kg_m2: I_e, the same about the vertical.
        drive: force of one motor for one unit of its input (N/V or N/A).
        damping_N_s_m: β of one motor, F = drive·input - β·v.
        friction_N: what rolling and the motors' friction take from the forward force.
        speed_noise_m2_s3: density of what the motors do not say of dv/dt.
        turn_noise_rad2_s3: the same of dω/dt.
    """

    radius_m: float
    track_m: float
    inertia_kg: float = 1.0
    turning_inertia_kg_m2: float = 1.0
    drive: float = 0.0
    damping_N_s_m: float = 0.0
    friction_N: float = 0.0
    speed_noise_m2_s3: float = 0.0
    turn_noise_rad2_s3: float = 0.0

    @property
    def decay_1_s(self) -> float:
        """λ of the speed."""
        return 2 * self.damping_N_s_m / self.inertia_kg

    @property
    def turn_decay_1_s(self) -> float:
        """λ' of the turning rate."""
        return self.damping_N_s_m * self.track_m**2 / (2 * self.turning_inertia_kg_m2)

    def push_m_s2(self, speed_m_s: float, left: float, right: float) -> float:
        """g: acceleration by both motors less friction, which never drives."""
        force = self.drive * (left + right)
        if abs(speed_m_s) < _RESTS_M_S:
            return math.copysign(max(abs(force) - self.friction_N, 0.0), force) / self.inertia_kg
        return (force - math.copysign(self.friction_N, speed_m_s)) / self.inertia_kg

    def turn_rad_s2(self, left: float, right: float) -> float:
        """h: angular acceleration by the difference of the motors."""
        return self.drive * (right - left) * self.track_m / 2 / self.turning_inertia_kg_m2


def move(robot: Robot, mean: Array, step_s: float, left: float, right: float) -> Motion:
    """The motion of one step under inputs that are held."""
    speed, kept = _decayed(
        mean[SPEED], robot.decay_1_s, robot.push_m_s2(mean[SPEED], left, right), step_s
    )
    rate, turn_kept = _decayed(
        mean[RATE], robot.turn_decay_1_s, robot.turn_rad_s2(left, right), step_s
    )
    # mean speed of the step, along the heading in its middle
    middle = mean[HEADING] + step_s * (3 * mean[RATE] + rate) / 8
    way = step_s * (mean[SPEED] + speed) / 2
    along = np.array([math.cos(middle), math.sin(middle)])
    aside = np.array([-along[1], along[0]])
    after = np.array(
        [*(mean[:2] + way * along), mean[HEADING] + step_s * (mean[RATE] + rate) / 2, speed, rate]
    )
    transition = np.eye(5)
    transition[:2, HEADING] = way * aside
    transition[:2, SPEED] = step_s * (1 + kept) / 2 * along
    transition[:2, RATE] = way * aside * step_s * (3 + turn_kept) / 8
    transition[HEADING, RATE] = step_s * (1 + turn_kept) / 2
    transition[SPEED, SPEED], transition[RATE, RATE] = kept, turn_kept
    return Motion(after, transition, _noise(robot, step_s, along))


def _decayed(value: float, decay: float, push: float, step_s: float) -> tuple[float, float]:
    """A rate after a step of dv/dt = push - decay·v, and which part of it was kept."""
    kept = math.exp(-decay * step_s)
    gained = push * (step_s if decay == 0 else -math.expm1(-decay * step_s) / decay)
    return value * kept + gained, kept


#: places and weights between 0 and 1 at which integrals over a step are taken (Gauss and Legendre)
_PLACES, _WEIGHTS = (both / 2 for both in np.polynomial.legendre.leggauss(12))
_PLACES = _PLACES + 0.5


def _noise(robot: Robot, step_s: float, along: Array) -> Array:
    """Q of white accelerations, along the heading and about the vertical."""
    forward, turning = np.zeros((5, 2)), np.zeros((5, 2))
    forward[:2, 0], forward[SPEED, 1] = along, 1.0
    turning[HEADING, 0], turning[RATE, 1] = 1.0, 1.0
    shaken = robot.speed_noise_m2_s3 * _shaken(robot.decay_1_s, step_s)
    turned = robot.turn_noise_rad2_s3 * _shaken(robot.turn_decay_1_s, step_s)
    return np.asarray(forward @ shaken @ forward.T + turning @ turned @ turning.T)


def _shaken(decay: float, step_s: float) -> Array:
    """Covariance (2, 2) of way and speed after a step of white acceleration of density 1.

    A jolt τ before the end has left exp(-λτ) of its speed, and a way of (1 - exp(-λτ))/λ; Q is the
    integral of their products. Undamped it is t³/3, t²/2, t.
    """
    ago_s = step_s * _PLACES
    way = ago_s if decay == 0 else -np.expm1(-decay * ago_s) / decay
    left = np.array([way, np.exp(-decay * ago_s)])
    return np.asarray(step_s * (left * _WEIGHTS) @ left.T)


def wheel_rates(
    robot: Robot, mean: Array, left: float, right: float, gate_s: float = 0.0
) -> tuple[Array, Array]:
    """Rates of the left and the right wheel (2,) and their derivatives (2, 5).

    Counted in a gate they are means over it, half a gate old.
    """
    half_s = gate_s / 2
    push = robot.push_m_s2(mean[SPEED], left, right)
    turn = robot.turn_rad_s2(left, right)
    grown, turn_grown = 1 + half_s * robot.decay_1_s, 1 + half_s * robot.turn_decay_1_s
    speed, rate = mean[SPEED] * grown - half_s * push, mean[RATE] * turn_grown - half_s * turn
    side = np.array([-1.0, 1.0]) * robot.track_m / 2
    slopes = np.zeros((2, 5))
    slopes[:, SPEED], slopes[:, RATE] = grown, side * turn_grown
    return (speed + side * rate) / robot.radius_m, slopes / robot.radius_m


@dataclass(frozen=True)
class Ranger:
    """A range sensor on the robot.

    Attributes:
        ahead_m: its place ahead of the axle. left_m: to the left of the middle.
        beam_rad: direction of its beam, from ahead to the left.
    """

    ahead_m: float = 0.0
    left_m: float = 0.0
    beam_rad: float = 0.0

    def place(self, mean: Array) -> tuple[Array, Array]:
        """Where it is (2,), and the derivative of that after the heading (2,)."""
        c, s = math.cos(mean[HEADING]), math.sin(mean[HEADING])
        arm = np.array([c * self.ahead_m - s * self.left_m, s * self.ahead_m + c * self.left_m])
        return mean[:2] + arm, np.array([-arm[1], arm[0]])


def range_to_beacon(ranger: Ranger, mean: Array, beacon_m: Array) -> tuple[float, Array]:
    """Distance to a beacon, and its derivatives (5,)."""
    place, turned = ranger.place(mean)
    away = place - beacon_m
    distance = float(np.hypot(*away)) or 1e-12
    slopes = np.zeros(5)
    slopes[:2] = away / distance
    slopes[HEADING] = slopes[:2] @ turned
    return distance, slopes


def range_to_wall(
    ranger: Ranger, mean: Array, normal_rad: float, wall_m: float
) -> tuple[float, Array]:
    """Distance along the beam to the wall n·p = d, and its derivatives (5,).

    Args:
        ranger: the sensor.
        mean: the states.
        normal_rad: direction of n, from the origin to the wall.
        wall_m: distance d of the wall from the origin.
    """
    place, turned = ranger.place(mean)
    normal = np.array([math.cos(normal_rad), math.sin(normal_rad)])
    angle = mean[HEADING] + ranger.beam_rad
    beam, aside = (
        np.array([math.cos(angle), math.sin(angle)]),
        np.array([-math.sin(angle), math.cos(angle)]),
    )
    towards = float(normal @ beam) or 1e-12
    distance = (wall_m - float(normal @ place)) / towards
    slopes = np.zeros(5)
    slopes[:2] = -normal / towards
    slopes[HEADING] = -(normal @ turned) / towards - distance * (normal @ aside) / towards
    return distance, slopes
