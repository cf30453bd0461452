"""Closed form of the robot driven straight ahead by a torque that is constant or grows in time.

The forces of ``straight.py`` beside this file are linear in the torque. So while a torque that is
linear in time neither sets the robot off nor makes its tyres slide, all accelerations are linear in
time and the motion is a cubic. The instants between are known: there the torque passes a threshold.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.body_signals import unturned
from simcompare.scenarios.robot.straight import Forces, Straight

#: (time [s], torque of each wheel [N·m]) where a torque begins or bends
Knots = Sequence[tuple[float, float]]
#: the two wheels, and on which side of the middle they are
SIDES = {"left": 1, "right": -1}


@dataclass(frozen=True)
class Motion:
    """How the robot drives straight ahead, all (n,).

    Attributes:
        distance_m: from the start. speed_m_s: its rate. angle_rad: of the wheels. rate_rad_s: its
        rate. caster_N: load of the caster.
    """

    distance_m: Array
    speed_m_s: Array
    angle_rad: Array
    rate_rad_s: Array
    caster_N: Array


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """All signals of the robot under a constant torque.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].

    Returns:
        Motion of the three bodies, angles of both wheels, torques, loads of the contacts.
    """
    torque = parameters["torque_N_m"]
    motion = driven(Straight.of(parameters), ((0.0, torque),), time_s)
    torques = {f"{side}_motor.torque_N_m": np.full(len(time_s), torque) for side in SIDES}
    return {**robot_signals(parameters, motion), **torques}


def driven(robot: Straight, knots: Knots, time_s: Array) -> Motion:
    """Motion from rest under a torque that never falls.

    Args:
        robot: the robot.
        knots: where the torque begins (at time 0) and bends; straight lines between them, constant
            after the last.
        time_s: times (n,) [s].
    """
    rows = np.zeros((5, len(time_s)))
    state = (0.0, 0.0, 0.0, 0.0)
    for piece in _pieces(robot, knots):
        inside = (time_s >= piece.start_s) & (time_s < piece.end_s)
        rows[:, inside] = piece.motion(state, time_s[inside])
        if math.isfinite(piece.end_s):
            x, v, angle, rate, _ = piece.motion(state, np.array([piece.end_s]))
            state = (float(x[0]), float(v[0]), float(angle[0]), float(rate[0]))
    return Motion(*rows)


def robot_signals(parameters: Mapping[str, float], motion: Motion) -> dict[str, Array]:
    """Signals of the bodies, the joints and the contacts of a robot that drives straight ahead."""
    robot = Straight.of(parameters)
    load = robot.mass_kg * robot.gravity_m_s2 - motion.caster_N
    signals = {
        **body_signals("chassis", motion, (-robot.behind_m, 0.0, robot.height_m)),
        "caster.normal_force_N": motion.caster_N,
    }
    for side, sign in SIDES.items():
        start = (0.0, sign * parameters["track_m"] / 2, robot.radius_m)
        signals |= wheel_signals(f"{side}_wheel", side, motion, start)
        signals[f"{side}_tyre.normal_force_N"] = load / 2
    return signals


def body_signals(name: str, motion: Motion, start_m: Sequence[float]) -> dict[str, Array]:
    """Signals of a body that is carried along without turning."""
    count = len(motion.distance_m)
    position, velocity = np.tile(start_m, (count, 1)), np.zeros((count, 3))
    position[:, 0] += motion.distance_m
    velocity[:, 0] = motion.speed_m_s
    return unturned(name, position, velocity)


def wheel_signals(
    name: str, joint: str, motion: Motion, start_m: Sequence[float]
) -> dict[str, Array]:
    """Signals of a wheel that turns about +y, and of its hinge."""
    signals = body_signals(name, motion, start_m)
    half, zero = motion.angle_rad / 2, np.zeros(len(motion.angle_rad))
    return {
        **signals,
        f"{name}.orientation_wxyz": np.column_stack((np.cos(half), zero, np.sin(half), zero)),
        f"{name}.rate_rad_s": np.column_stack((zero, motion.rate_rad_s, zero)),
        f"{joint}.angle_rad": motion.angle_rad,
        f"{joint}.rate_rad_s": motion.rate_rad_s,
    }


@dataclass(frozen=True)
class _Piece:
    """A stretch of time in which all accelerations are linear in time.

    Attributes:
        start_s: its first moment. end_s: its end, maybe never. begin: accelerations and load in the
        first moment. growth: what they grow by in a second.
    """

    start_s: float
    end_s: float
    begin: Forces
    growth: Forces

    def motion(self, state: Sequence[float], time_s: Array) -> tuple[Array, ...]:
        """Distance, speed, angle, rate and load, for the state (of the first four) at its start."""
        x, v, angle, rate = state
        s = time_s - self.start_s
        begin, growth = self.begin, self.growth
        return (
            *_cubic(x, v, begin.acceleration_m_s2, growth.acceleration_m_s2, s),
            *_cubic(angle, rate, begin.spin_rad_s2, growth.spin_rad_s2, s),
            begin.caster_N + growth.caster_N * s,
        )


def _cubic(x: float, v: float, a: float, growth: float, s: Array) -> tuple[Array, Array]:
    """A coordinate and its rate, s after it was x with the rate v and the acceleration a."""
    return x + v * s + a * s**2 / 2 + growth * s**3 / 6, v + a * s + growth * s**2 / 2


def _pieces(robot: Straight, knots: Knots) -> Iterator[_Piece]:
    """The time cut where the torque bends and where it passes a threshold of the robot."""
    for (start_s, low), (end_s, high) in itertools.pairwise(knots):
        passed = (robot.start_torque, robot.slip_torque)
        torques = [low, *(torque for torque in passed if low < torque < high), high]
        for one, two in itertools.pairwise(torques):
            begin, end = robot.forces(one), robot.forces(two)
            share = (end_s - start_s) / (high - low) if high > low else math.nan
            first = start_s + (one - low) * share if one > low else start_s
            last = start_s + (two - low) * share if two < high else end_s
            # both ends may be taken at a threshold: the forces are continuous there
            yield _Piece(first, last, begin, begin.change_to(end, last - first))
    start_s, torque = knots[-1]
    yield _Piece(start_s, math.inf, robot.forces(torque), Forces(0.0, 0.0, 0.0))
