"""A robot on two driven wheels as a filter sees it: its states, their motion, what sensors read.

The states are the place x, y of the middle of the axle, the heading θ, the speed v along it, the
turning rate ω, and the accelerations p and q that the motors do not explain: friction that is not
as told, a motor that is weaker, a slope. Two motors give the forward force and the turning moment;
both are braked in proportion to the speed. With λ = damping/inertia

    dx/dt = v·cos θ    dy/dt = v·sin θ    dθ/dt = ω
    dv/dt = g - λ·v + p - κ·ω²            dω/dt = h - λ'·ω + q + κ'·v·ω

What changes p and q is white jerk. κ and κ' are those of a load behind the axle, which pushes a
robot further into its curve (Newton and Euler in the plane, for wheels that roll). Two more states
are the ways that the wheels have rolled, v - ω·W/2 and v + ω·W/2 summed up. The last two are the
parts by which each motor is stronger than told: they stay as they are, so they are no jerk.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.estimation.kalman import Motion
from simcompare.model.trajectory import Array

#: places of the states
X, Y, HEADING, SPEED, RATE, PUSH, TURN, LEFT, RIGHT, LEFT_MOTOR, RIGHT_MOTOR = range(11)
#: how many there are
STATES = 11
#: of a robot that is slower no sensor tells which way it goes: friction is against the motors [m/s]
_RESTS_M_S = 0.01
#: λ·T below which a motion is not damped
_UNDAMPED = 1e-6


@dataclass(frozen=True)
class Robot:
    """Numbers of the robot.

    Attributes:
        radius_m: of the wheels.
        track_m: distance of the wheels.
        inertia_kg: M_e, the mass with what wheels and rotors add.
        turning_inertia_kg_m2: I_e, the same about the vertical through the middle of the axle.
        drive: force of one motor for one unit of its input (N/V or N/A).
        damping_N_s_m: β of one motor, F = drive·input - β·v.
        friction_N: what rolling and the motors' friction take from the forward force.
        load_behind_kg_m: mass times how far its centre lies behind the axle.
        jerk_density_m2_s5: density of what changes p.
        turn_jerk_density_rad2_s5: the same of q.
        lag_s: time by which the accelerations may be early or late.
        settling_s: time in which the motion settles. What is early or late by lag_s is off by
            lag_s/settling_s of itself, and that changes as the motion settles.
    """

    radius_m: float
    track_m: float
    inertia_kg: float = 1.0
    turning_inertia_kg_m2: float = 1.0
    drive: float = 0.0
    damping_N_s_m: float = 0.0
    friction_N: float = 0.0
    load_behind_kg_m: float = 0.0
    jerk_density_m2_s5: float = 0.0
    turn_jerk_density_rad2_s5: float = 0.0
    lag_s: float = 0.0
    settling_s: float = 1.0

    @property
    def decay_1_s(self) -> float:
        """λ of the speed."""
        return 2 * self.damping_N_s_m / self.inertia_kg

    @property
    def turn_decay_1_s(self) -> float:
        """λ' of the turning rate."""
        return self.damping_N_s_m * self.track_m**2 / (2 * self.turning_inertia_kg_m2)

    @property
    def off_by(self) -> float:
        """Part of the accelerations by which they may be off."""
        return self.lag_s / self.settling_s

    def push_m_s2(self, speed_m_s: float, left: float, right: float) -> float:
        """g: acceleration by both motors less friction, which never drives."""
        force = self.drive * (left + right)
        if abs(speed_m_s) < _RESTS_M_S:
            return math.copysign(max(abs(force) - self.friction_N, 0.0), force) / self.inertia_kg
        return (force - math.copysign(self.friction_N, speed_m_s)) / self.inertia_kg

    def turn_rad_s2(self, left: float, right: float) -> float:
        """h: angular acceleration by the difference of the motors."""
        return self.drive * (right - left) * self.track_m / 2 / self.turning_inertia_kg_m2


def accelerations(robot: Robot, mean: Array, left: float, right: float) -> tuple[Array, Array]:
    """dv/dt and dω/dt (2,) at given inputs, and their derivatives (2, 11)."""
    speed, rate = mean[SPEED], mean[RATE]
    back = robot.load_behind_kg_m / robot.inertia_kg
    turned = robot.load_behind_kg_m / robot.turning_inertia_kg_m2
    forward = robot.push_m_s2(speed, left, right) - robot.decay_1_s * speed - back * rate**2
    turning = robot.turn_rad_s2(left, right) - robot.turn_decay_1_s * rate + turned * speed * rate
    slopes = np.zeros((2, STATES))
    slopes[0, [SPEED, RATE, PUSH]] = -robot.decay_1_s, -2 * back * rate, 1.0
    slopes[1, [SPEED, RATE, TURN]] = turned * rate, turned * speed - robot.turn_decay_1_s, 1.0
    found = np.array([forward + mean[PUSH], turning + mean[TURN]])
    for motor, given, arm in zip(
        (LEFT_MOTOR, RIGHT_MOTOR), (left, right), np.array([-1, 1]) * robot.track_m / 2, strict=True
    ):
        acts = np.array([1 / robot.inertia_kg, arm / robot.turning_inertia_kg_m2])
        force = robot.drive * given - robot.damping_N_s_m * (speed + arm * rate)
        found += mean[motor] * force * acts
        slopes[:, motor] = force * acts
        slopes[:, SPEED] -= mean[motor] * robot.damping_N_s_m * acts
        slopes[:, RATE] -= mean[motor] * robot.damping_N_s_m * arm * acts
    return found, slopes


def move(robot: Robot, mean: Array, step_s: float, left: float, right: float) -> Motion:
    """The motion of one step under inputs that are held, and a load behind that pushes evenly."""
    now, slopes = accelerations(robot, mean, left, right)
    one = np.eye(STATES)
    speeds, rows = mean[[SPEED, RATE]].copy(), one[[SPEED, RATE]]
    for i, decay in enumerate((robot.decay_1_s, robot.turn_decay_1_s)):
        # an acceleration that decays with the speed that it gains: ∫exp(-λ·t)
        lasts_s = step_s if decay * step_s < _UNDAMPED else -math.expm1(-decay * step_s) / decay
        speeds[i] += lasts_s * now[i]
        rows[i] = rows[i] + lasts_s * slopes[i]
    # mean speed of the step, along the heading in its middle
    middle = mean[HEADING] + step_s * (3 * mean[RATE] + speeds[1]) / 8
    way, turned = step_s * (mean[SPEED] + speeds[0]) / 2, step_s * (mean[RATE] + speeds[1]) / 2
    middle_row = one[HEADING] + step_s * (3 * one[RATE] + rows[1]) / 8
    way_row, turned_row = step_s * (one[SPEED] + rows[0]) / 2, step_s * (one[RATE] + rows[1]) / 2
    along = np.array([math.cos(middle), math.sin(middle)])
    aside = np.array([-along[1], along[0]])
    side = np.array([-1.0, 1.0]) * robot.track_m / 2
    after, transition = mean.copy(), one.copy()
    after[[X, Y]] += way * along
    transition[[X, Y]] += np.outer(along, way_row) + way * np.outer(aside, middle_row)
    after[HEADING] += turned
    transition[HEADING] += turned_row
    after[[SPEED, RATE]], transition[[SPEED, RATE]] = speeds, rows
    after[[LEFT, RIGHT]] += way + side * turned
    transition[[LEFT, RIGHT]] += way_row + np.outer(side, turned_row)
    return Motion(after, transition, _noise(robot, step_s, along, now))


#: places and weights between 0 and 1 at which integrals over a step are taken (Gauss and Legendre)
_PLACES, _WEIGHTS = (both / 2 for both in np.polynomial.legendre.leggauss(12))
_PLACES = _PLACES + 0.5


def _noise(robot: Robot, step_s: float, along: Array, now: Array) -> Array:
    """Q of white jerk, along the heading and about the vertical, at accelerations now (2,)."""
    forward, turning = np.zeros((STATES, 3)), np.zeros((STATES, 3))
    forward[[X, Y], 0], forward[[LEFT, RIGHT], 0] = along, 1.0
    forward[SPEED, 1] = forward[PUSH, 2] = 1.0
    turning[HEADING, 0] = turning[RATE, 1] = turning[TURN, 2] = 1.0
    turning[[LEFT, RIGHT], 0] = np.array([-1.0, 1.0]) * robot.track_m / 2
    late = np.square(robot.off_by * now) / robot.settling_s
    shaken = (robot.jerk_density_m2_s5 + late[0]) * _shaken(robot.decay_1_s, step_s)
    turned = (robot.turn_jerk_density_rad2_s5 + late[1]) * _shaken(robot.turn_decay_1_s, step_s)
    return np.asarray(forward @ shaken @ forward.T + turning @ turned @ turning.T)


def _shaken(decay: float, step_s: float) -> Array:
    """Covariance (3, 3) of way, speed and push after a step of white jerk of density 1.

    A jolt τ before the end has left a push of 1, a speed of (1 - exp(-λτ))/λ, and as a way the sum
    of that; Q is the integral of their products. Undamped these are 1, τ, τ²/2.
    """
    ago_s = step_s * _PLACES
    if decay * step_s < _UNDAMPED:
        speed, way = ago_s, ago_s**2 / 2
    else:
        speed = -np.expm1(-decay * ago_s) / decay
        way = (ago_s - speed) / decay
    left = np.array([way, speed, np.ones_like(ago_s)])
    return np.asarray(step_s * (left * _WEIGHTS) @ left.T)


def wheel_rates(robot: Robot, mean: Array) -> tuple[Array, Array]:
    """Rates of the left and the right wheel (2,) and their derivatives (2, 11)."""
    slopes = np.zeros((2, STATES))
    slopes[:, SPEED] = 1 / robot.radius_m
    slopes[:, RATE] = np.array([-1.0, 1.0]) * robot.track_m / 2 / robot.radius_m
    return slopes @ mean[:STATES], slopes


@dataclass(frozen=True)
class Ranger:
    """A range sensor on the robot.

    Attributes:
        ahead_m: its place ahead of the axle. left_m: to the left of the middle.
        beam_rad: where it looks, from ahead to the left.
        zone_rad: where its beam goes from there, to the left; told is how far along the first.
    """

    ahead_m: float = 0.0
    left_m: float = 0.0
    beam_rad: float = 0.0
    zone_rad: float = 0.0

    def place(self, mean: Array) -> tuple[Array, Array]:
        """Where it is (2,), and the derivative of that after the heading (2,)."""
        c, s = math.cos(mean[HEADING]), math.sin(mean[HEADING])
        arm = np.array([c * self.ahead_m - s * self.left_m, s * self.ahead_m + c * self.left_m])
        return mean[:2] + arm, np.array([-arm[1], arm[0]])


def range_to_beacon(ranger: Ranger, mean: Array, beacon_m: Array) -> tuple[float, Array]:
    """Distance to a beacon, and its derivatives (11,)."""
    place, turned = ranger.place(mean)
    away = place - beacon_m
    distance = float(np.hypot(*away)) or 1e-12
    slopes = np.zeros(STATES)
    slopes[:2] = away / distance
    slopes[HEADING] = slopes[:2] @ turned
    return distance, slopes


def range_to_wall(
    ranger: Ranger, mean: Array, normal_rad: float, wall_m: float
) -> tuple[float, Array]:
    """What is told of the beam's end on the wall n·p = d, and its derivatives (11,).

    Args:
        ranger: the sensor.
        mean: the states.
        normal_rad: direction of n, from the origin to the wall.
        wall_m: distance d of the wall from the origin.
    """
    place, turned = ranger.place(mean)
    normal = np.array([math.cos(normal_rad), math.sin(normal_rad)])
    angle = mean[HEADING] + ranger.beam_rad + ranger.zone_rad
    beam, aside = (
        np.array([math.cos(angle), math.sin(angle)]),
        np.array([-math.sin(angle), math.cos(angle)]),
    )
    towards = float(normal @ beam) or 1e-12
    distance = (wall_m - float(normal @ place)) / towards
    slopes = np.zeros(STATES)
    slopes[:2] = -normal / towards
    slopes[HEADING] = -(normal @ turned) / towards - distance * (normal @ aside) / towards
    told = math.cos(ranger.zone_rad)
    return told * distance, told * slopes
