"""Exact motion of an arm of two rods that is held, let go and swings, and what its sensors read.

With θ₁, θ₂ the angles of the links from hanging down (about +y), A₁ = I₁ + m₁·l₁² + m₂·L₁²,
A₂ = I₂ + m₂·l₂² and c = m₂·L₁·l₂ (L lengths, l = L/2, I about the middle), Lagrange's equations are

    A₁·θ̈₁ + c·cos(θ₁-θ₂)·θ̈₂ + c·sin(θ₁-θ₂)·θ̇₂² = -(m₁·l₁ + m₂·L₁)·g·sin θ₁ + τ₁ - τ₂
    A₂·θ̈₂ + c·cos(θ₁-θ₂)·θ̈₁ - c·sin(θ₁-θ₂)·θ̇₁² = -m₂·l₂·g·sin θ₂ + τ₂

(Landau and Lifshitz, Mechanics, §5, problem 1, for rods and with torques). While the torques carry
the weight nothing moves; after that the equations are integrated by DOP853 at 1e-12.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from simcompare.model.trajectory import Array

#: longest step of the integration [s]; between its steps it interpolates to the seventh order
LONGEST_STEP_S = 0.005
TOLERANCE = 1e-12


@dataclass(frozen=True)
class Arm:
    """The arm's constants, and its equations of motion.

    Attributes:
        inertia: A₁, A₂ and c [kg·m²].
        weight: torque of the weight for sin θ = 1, of either link [N·m].
        start_rad: angles θ₁, θ₂ while it is held.
        hold_s: time until which the torques hold it.
        release_s: time in which they fade.
    """

    inertia: tuple[float, float, float]
    weight: tuple[float, float]
    start_rad: tuple[float, float]
    hold_s: float
    release_s: float

    def accelerations(self, time_s: Array, angles: Array, rates: Array) -> Array:
        """Angular accelerations (2, n) of both links [rad/s²] from angles and rates (2, n)."""
        first, second, c = self.inertia
        apart = angles[0] - angles[1]
        cosine, sine = c * np.cos(apart), c * np.sin(apart)
        held = np.clip(1 - (time_s - self.hold_s) / self.release_s, 0.0, 1.0)
        pull = [
            w * (held * np.sin(start) - np.sin(angle))
            for w, start, angle in zip(self.weight, self.start_rad, angles, strict=True)
        ]
        right = (pull[0] - sine * rates[1] ** 2, pull[1] + sine * rates[0] ** 2)
        determinant = first * second - cosine**2
        return np.array(
            (
                (second * right[0] - cosine * right[1]) / determinant,
                (first * right[1] - cosine * right[0]) / determinant,
            )
        )


def arm_of(parameters: Mapping[str, float]) -> Arm:
    """The arm of a scenario's parameters."""
    upper, fore = parameters["upper_length_m"], parameters["fore_length_m"]
    m_1, m_2 = parameters["upper_mass_kg"], parameters["fore_mass_kg"]
    gravity, first = parameters["gravity_m_s2"], parameters["upper_angle_rad"]
    return Arm(
        # a rod about its end has m·L²/3
        inertia=(m_1 * upper**2 / 3 + m_2 * upper**2, m_2 * fore**2 / 3, m_2 * upper * fore / 2),
        weight=((m_1 / 2 + m_2) * upper * gravity, m_2 * fore / 2 * gravity),
        start_rad=(first, first + parameters["elbow_angle_rad"]),
        hold_s=parameters["hold_s"],
        release_s=parameters["release_s"],
    )


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the arm and what its sensors read at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].

    Returns:
        Coordinates and rates of both joints (n,), specific forces and rates (n, 3) of all sensors.
    """
    arm = arm_of(parameters)
    angles, rates = motion(arm, time_s)
    accelerations = arm.accelerations(time_s, angles, rates)
    elbow = _elbow_felt(parameters, angles[0], rates[0], accelerations[0])
    signals = {
        "shoulder.angle_rad": angles[0] - arm.start_rad[0],
        "shoulder.rate_rad_s": rates[0],
        "elbow.angle_rad": angles[1] - angles[0] - parameters["elbow_angle_rad"],
        "elbow.rate_rad_s": rates[1] - rates[0],
    }
    zero = np.zeros(len(time_s))
    levers = {"upper": parameters["upper_sensor_m"], "fore": -parameters["fore_sensor_m"]}
    for i, (link, lever) in enumerate(levers.items()):
        across, up = _in_link(elbow, angles[i])
        outer = (across + lever * accelerations[i], zero, up - lever * rates[i] ** 2)
        signals[f"{link}_axis.specific_force_m_s2"] = np.column_stack((across, zero, up))
        signals[f"{link}_outer.specific_force_m_s2"] = np.column_stack(outer)
        signals[f"{link}_gyro.rate_rad_s"] = np.column_stack((zero, rates[i], zero))
    return signals


def motion(arm: Arm, time_s: Array) -> tuple[Array, Array]:
    """Angles and rates (2, n) of both links from hanging down."""
    angles = np.repeat(np.array(arm.start_rad)[:, None], len(time_s), axis=1)
    rates = np.zeros_like(angles)
    state = np.array([*arm.start_rad, 0.0, 0.0])

    def change(t: float, y: Array) -> Array:
        return np.concatenate((y[2:], arm.accelerations(np.asarray(t), y[:2], y[2:])))

    # the torques have a corner where they begin to fade, and one where they end
    corners = (arm.hold_s, arm.hold_s + arm.release_s, max(float(time_s[-1]), 0.0) + 1e-9)
    for start, end in itertools.pairwise(corners):
        if start >= time_s[-1]:
            break
        solution = solve_ivp(
            change, (start, end), state, "DOP853", dense_output=True,
            rtol=TOLERANCE, atol=TOLERANCE, max_step=LONGEST_STEP_S,
        )  # fmt: skip
        inside = (time_s > start) & (time_s <= end)
        if inside.any():
            assert solution.sol is not None
            values = solution.sol(time_s[inside])
            angles[:, inside], rates[:, inside] = values[:2], values[2:]
        state = solution.y[:, -1]
    return angles, rates


def _elbow_felt(
    parameters: Mapping[str, float], angle: Array, rate: Array, acceleration: Array
) -> tuple[Array, Array]:
    """Specific force a - g at the elbow, which is at (-L₁·sin θ₁, -L₁·cos θ₁): x and z, world."""
    length = parameters["upper_length_m"]
    sine, cosine = np.sin(angle), np.cos(angle)
    x = length * (rate**2 * sine - acceleration * cosine)
    z = length * (rate**2 * cosine + acceleration * sine)
    return x, z + parameters["gravity_m_s2"]


def _in_link(felt: tuple[Array, Array], angle: Array) -> tuple[Array, Array]:
    """A vector of the world's x-z plane in a frame that is turned about +y: across, up."""
    x, z = felt
    return x * np.cos(angle) - z * np.sin(angle), x * np.sin(angle) + z * np.cos(angle)
