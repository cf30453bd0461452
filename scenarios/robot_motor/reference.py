"""Closed form of the robot driven by two geared motors with brushes at a constant voltage.

The torque at a wheel that turns at ω, less all friction that acts on its axle, is linear in ω:

    τ(ω) = η·N·(k·V/R - τ_c) - F_roll·r/2 - c·ω     c = η·N²·(k²/R + b_m)

and the rotor adds J_a = η·N²·J_r to the wheel's inertia. The forces of the robot's ``straight.py``
are linear in τ, so a rolling robot follows dv/dt = (v∞ - v)/T, from rest v = v∞·(1 - exp(-t/T)):
with a caster that slides freely T = M/D, M = m + 2·(J + J_a)/r², D = 2c/r², v∞ = 2·τ(0)/(r·D).
While the tyres spin, ω approaches its own terminal rate, and the speed is the integral of what is
linear in ω; the tyres grip once v has come up to r·ω.
Source: the motor's equation, its inductance left out; tests integrate the three bodies instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields

import numpy as np
from scipy.optimize import brentq

from simcompare.model.trajectory import Array
from simcompare.scenarios.robot.reference import SIDES, Motion, robot_signals
from simcompare.scenarios.robot.straight import Forces, Straight


@dataclass(frozen=True)
class Drive:
    """What a motor with its gear gives to a wheel, less all friction on the axle.

    Attributes:
        stall_N_m: torque at the first turn. damping_N_m_s_rad: what it falls by with the rate.
        armature_kg_m2: the rotor's inertia as the wheel feels it.
    """

    stall_N_m: float
    damping_N_m_s_rad: float
    armature_kg_m2: float

    @classmethod
    def of(cls, parameters: Mapping[str, float]) -> Drive:
        """The drive of a scenario's parameters."""
        k, resistance = parameters["torque_constant_N_m_A"], parameters["resistance_Ohm"]
        ratio, share = parameters["gear_ratio"], parameters["efficiency"]
        inner = k * parameters["voltage_V"] / resistance - parameters["rotor_friction_N_m"]
        weight = Straight.of(parameters).mass_kg * parameters["gravity_m_s2"]
        rolling = parameters["rolling_resistance"] * weight * parameters["wheel_radius_m"] / 2
        viscous = k**2 / resistance + parameters["rotor_damping_N_m_s_rad"]
        return cls(
            stall_N_m=share * ratio * inner - rolling,
            damping_N_m_s_rad=share * ratio**2 * viscous,
            armature_kg_m2=share * ratio**2 * parameters["rotor_inertia_kg_m2"],
        )


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """All signals of the robot from rest.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].

    Returns:
        Motion of the three bodies, angles of both wheels, torques, voltages and currents of the
        motors, loads of the contacts.
    """
    motion = motion_at(parameters, time_s)
    k, ratio = parameters["torque_constant_N_m_A"], parameters["gear_ratio"]
    voltage = np.full(len(time_s), parameters["voltage_V"])
    current = (voltage - k * ratio * motion.rate_rad_s) / parameters["resistance_Ohm"]
    signals = robot_signals(parameters, motion)
    for side in SIDES:
        signals[f"{side}_motor.voltage_V"] = voltage
        signals[f"{side}_motor.current_A"] = current
        signals[f"{side}_motor.torque_N_m"] = parameters["efficiency"] * ratio * k * current
    return signals


def motion_at(parameters: Mapping[str, float], time_s: Array) -> Motion:
    """How the robot drives: not at all, rolling, or first with spinning wheels."""
    drive = Drive.of(parameters)
    robot = Straight.of(parameters, drive.armature_kg_m2)
    if drive.stall_N_m <= robot.start_torque:
        still, load = np.zeros(len(time_s)), robot.forces(0.0).caster_N
        return Motion(still, still, still, still, still + load)
    if drive.stall_N_m <= robot.slip_torque:
        return _rolling(robot, drive, time_s, (0.0, 0.0, 0.0))
    grip_s = _grip_s(robot, drive)
    before = _spinning(robot, drive, time_s)
    then = _spinning(robot, drive, np.array([grip_s]))
    start = (float(then.distance_m[0]), float(then.speed_m_s[0]), float(then.angle_rad[0]))
    after = _rolling(robot, drive, time_s - grip_s, start)
    parts = (
        np.where(time_s < grip_s, getattr(before, part.name), getattr(after, part.name))
        for part in fields(Motion)
    )
    return Motion(*parts)


@dataclass(frozen=True)
class _Linear:
    """Accelerations and load as begin + change·ω."""

    begin: Forces
    change: Forces


def _linear(forces: Callable[[float], Forces], drive: Drive) -> _Linear:
    """Forces of rolling or of sliding wheels over the rate ω at which they turn."""
    begin = forces(drive.stall_N_m)
    return _Linear(begin, begin.change_to(forces(drive.stall_N_m - drive.damping_N_m_s_rad)))


def _rolling(
    robot: Straight, drive: Drive, time_s: Array, start: tuple[float, float, float]
) -> Motion:
    """Motion with rolling wheels, from a distance, a speed and an angle at time 0 on."""
    (x, v, angle), r = start, robot.radius_m
    linear = _linear(robot.rolling, drive)
    constant_s = -r / linear.change.acceleration_m_s2
    terminal = linear.begin.acceleration_m_s2 * constant_s
    gone = -np.expm1(-np.maximum(time_s, 0.0) / constant_s)
    come = terminal * time_s - (terminal - v) * constant_s * gone
    speed = v + (terminal - v) * gone
    load = linear.begin.caster_N + linear.change.caster_N * speed / r
    return Motion(x + come, speed, angle + come / r, speed / r, load)


def _spinning(robot: Straight, drive: Drive, time_s: Array) -> Motion:
    """Motion with sliding tyres from rest at time 0 on."""
    linear = _linear(robot.sliding, drive)
    fall = -linear.change.spin_rad_s2
    terminal = linear.begin.spin_rad_s2 / fall
    gone = -np.expm1(-fall * time_s)
    angle = terminal * (time_s - gone / fall)
    # the integral of the angle
    twice = terminal * (time_s**2 / 2 - time_s / fall + gone / fall**2)
    a, change = linear.begin.acceleration_m_s2, linear.change.acceleration_m_s2
    rate = terminal * gone
    return Motion(
        a * time_s**2 / 2 + change * twice,
        a * time_s + change * angle,
        angle,
        rate,
        linear.begin.caster_N + linear.change.caster_N * rate,
    )


def _grip_s(robot: Straight, drive: Drive) -> float:
    """When spinning wheels have become as slow as the robot is fast [s]."""
    linear = _linear(robot.sliding, drive)

    def ahead(time_s: float) -> float:
        """How much faster the tyres move than the robot."""
        motion = _spinning(robot, drive, np.array([time_s]))
        return float(robot.radius_m * motion.rate_rad_s[0] - motion.speed_m_s[0])

    # the lead grows as long as tyres gain speed faster than the robot does, and falls afterwards
    begin, change, r = linear.begin, linear.change, robot.radius_m
    max_rate = (r * begin.spin_rad_s2 - begin.acceleration_m_s2) / (
        change.acceleration_m_s2 - r * change.spin_rad_s2
    )
    fall = -change.spin_rad_s2
    max_s = -math.log1p(-max_rate * fall / begin.spin_rad_s2) / fall
    late_s = 2 * max_s
    while ahead(late_s) > 0:
        late_s *= 2
    return float(brentq(ahead, max_s, late_s, xtol=1e-15, rtol=1e-14))
