"""A carriage in three rings on three stages, each held to its goal by a spring and a damper.

All bodies are centred in the point that is followed, so stages and rings do not feel each other.
A stage obeys q'' + 2ζω·q' + ω²·(q - goal) = 0; the weight is carried by where the spring of the
upright one is relaxed. The rings turn by ψ about z, by θ about the new y, by φ about the new x.
Each is the same about every axis, with the moments I_1, I_2, and I_3 of the carriage, so the
kinetic energy is (J_1·ψ'² + J_2·θ'² + I_3·φ'²)/2 - I_3·sin θ·ψ'·φ', and Lagrange's equations are

    J_1·ψ'' - I_3·(sin θ·φ'' + cos θ·θ'·φ') = J_1·(ω²·(goal - ψ) - 2ζω·ψ')
    J_2·θ'' + I_3·cos θ·ψ'·φ' = J_2·(ω²·(goal - θ) - 2ζω·θ')
    I_3·(φ'' - sin θ·ψ'' - cos θ·θ'·ψ') = I_3·(ω²·(goal - φ) - 2ζω·φ')

with J_1 = I_1 + I_2 + I_3 and J_2 = I_2 + I_3. The parts with I_3 on the left are what one axis
does to another. They are found by iteration: each axis is solved exactly with those of the round
before. The sensor at the place r feels

    f = Rᵀ·(a + g·z) + ω' × r + ω × (ω × r)

in its own frame, where ω = (φ' - ψ'·sin θ, θ'·cos φ + ψ'·cos θ·sin φ, ψ'·cos θ·cos φ - θ'·sin φ).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.model.rotations import conjugate, multiply, rotate
from simcompare.model.signals import Signal
from simcompare.model.trajectory import Array
from simcompare.scenarios.linear_response import Pieces, edges_of

STAGES, RINGS = ("x", "y", "z"), ("yaw", "pitch", "roll")
#: moments of inertia of the rings and the carriage over that of the carriage
I_1, I_2, I_3 = 4.0, 2.0, 1.0
J_1, J_2 = I_1 + I_2 + I_3, I_2 + I_3
#: longest piece in 1/ω
LONGEST_IN_LAGS = 1.5
#: of the iteration, as a part of ω² times the largest angle: a thousandth of what tests ask for
TOLERANCE = 1e-12
MAX_ROUNDS = 100


@dataclass(frozen=True)
class Motion:
    """Coordinates, rates and accelerations of one axis at the wanted times (n,) each."""

    place: Array
    rate: Array
    acceleration: Array


def reference(
    parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
) -> dict[str, Array]:
    """Coordinates of all axes, the carriage, and what its sensors read.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s], increasing.
        inputs: signals ``x_goal`` … ``roll_goal``.

    Raises:
        InputError: the motion comes so near to the zenith that three angles cannot follow it.
    """
    axes = motions(parameters, time_s, inputs)
    signals: dict[str, Array] = {}
    for name in STAGES:
        signals[f"{name}.position_m"] = axes[name].place - parameters[f"start_{name}_m"]
        signals[f"{name}.velocity_m_s"] = axes[name].rate
    for name in RINGS:
        signals[f"{name}.angle_rad"] = axes[name].place - parameters[f"start_{name}_rad"]
        signals[f"{name}.rate_rad_s"] = axes[name].rate
    turned = _orientation(*(axes[name].place for name in RINGS))
    rate, growth = _rates(*(axes[name] for name in RINGS))
    lever = np.array([parameters[f"lever_{axis}_m"] for axis in "xyz"])
    felt = np.column_stack([axes[name].acceleration for name in STAGES])
    felt[:, 2] += parameters["gravity_m_s2"]
    arm = np.cross(growth, lever) + np.cross(rate, np.cross(rate, lever))
    signals["accelerometer.specific_force_m_s2"] = rotate(conjugate(turned), felt) + arm
    signals["gyroscope.rate_rad_s"] = rate
    signals["carriage.position_m"] = np.column_stack([axes[name].place for name in STAGES])
    signals["carriage.velocity_m_s"] = np.column_stack([axes[name].rate for name in STAGES])
    signals["carriage.orientation_wxyz"] = turned
    signals["carriage.rate_rad_s"] = rotate(turned, rate)
    return signals


def motions(
    parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
) -> dict[str, Motion]:
    """How every axis moves."""
    omega, zeta = 2 * math.pi * parameters["bandwidth_Hz"], parameters["damping_ratio"]
    goals = {name: inputs[f"{name}_goal"] for name in (*STAGES, *RINGS)}
    edges, at = edges_of(time_s, tuple(goals.values()), LONGEST_IN_LAGS / omega)
    pieces = Pieces(edges)
    shape = pieces.inside.shape
    inside = {n: goal.at(pieces.inside.ravel()).reshape(shape) for n, goal in goals.items()}
    start = {
        **{n: (parameters[f"start_{n}_m"], 0.0) for n in STAGES},
        **{n: (parameters[f"start_{n}_rad"], 0.0) for n in RINGS},
    }
    servo = _Servo(pieces, omega, zeta)
    axes = {}
    for name in STAGES:
        _, (place, rate) = servo.response(inside[name], np.zeros(shape), start[name])
        pull = servo.pull(goals[name].at(edges), place, rate)
        axes[name] = Motion(place[at], rate[at], pull[at])
    rings = _rings(servo, [inside[n] for n in RINGS], [start[n] for n in RINGS])
    pulls = [servo.pull(goals[n].at(edges), *ring) for n, ring in zip(RINGS, rings, strict=True)]
    accelerations = _accelerations(pulls, rings)
    for name, (place, rate), acceleration in zip(RINGS, rings, accelerations, strict=True):
        axes[name] = Motion(place[at], rate[at], acceleration[at])
    return axes


@dataclass(frozen=True)
class _Servo:
    """A spring and a damper about a goal, over all pieces of time."""

    pieces: Pieces
    omega: float
    zeta: float

    def response(
        self, goal: Array, push: Array, start: tuple[float, float]
    ) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Coordinate and rate at the points, and at the edges."""
        return self.pieces.driven(self.omega**2 * goal + push, self.omega, self.zeta, start)

    def pull(self, goal: Array, place: Array, rate: Array) -> Array:
        """Acceleration that spring and damper give to what they hold."""
        return self.omega**2 * (goal - place) - 2 * self.zeta * self.omega * rate


def _rings(
    servo: _Servo, goals: list[Array], start: list[tuple[float, float]]
) -> list[tuple[Array, Array]]:
    """Angle and rate of yaw, pitch and roll at the edges."""
    shape = servo.pieces.inside.shape
    # what the other axes do to each is not known yet
    pushes = [np.zeros(shape) for _ in RINGS]
    scale = max(1.0, *(float(np.abs(goal).max()) for goal in goals))
    for _ in range(MAX_ROUNDS):
        with np.errstate(over="ignore", invalid="ignore"):
            both = [servo.response(*axis) for axis in zip(goals, pushes, start, strict=True)]
            inside = [ring for ring, _ in both]
            pulls = [servo.pull(goal, *ring) for goal, ring in zip(goals, inside, strict=True)]
            accelerations = _accelerations(pulls, inside)
            new = [whole - pull for whole, pull in zip(accelerations, pulls, strict=True)]
            change = max(float(np.abs(a - b).max()) for a, b in zip(new, pushes, strict=True))
        pushes = new
        if change <= TOLERANCE * servo.omega**2 * scale:
            return [edge for _, edge in both]
        if not np.isfinite(change):
            break
    fault = "the pitch comes so near to a quarter of a turn that yaw and roll cannot follow"
    raise InputError("inputs of the carriage", [f"{fault}; choose another window"])


def _accelerations(pulls: list[Array], rings: list[tuple[Array, Array]]) -> list[Array]:
    """Accelerations of yaw, pitch and roll: Lagrange's equations, solved for them."""
    (_, yaw_rate), (pitch, pitch_rate), (_, roll_rate) = rings
    sine, cosine = np.sin(pitch), np.cos(pitch)
    for_yaw = J_1 * pulls[0] + I_3 * cosine * pitch_rate * roll_rate
    for_roll = pulls[2] + cosine * pitch_rate * yaw_rate
    yaw = (for_yaw + I_3 * sine * for_roll) / (J_1 - I_3 * sine**2)
    return [yaw, pulls[1] - I_3 / J_2 * cosine * yaw_rate * roll_rate, for_roll + sine * yaw]


def _orientation(yaw: Array, pitch: Array, roll: Array) -> Array:
    """Quaternion of a turn about z, then about the new y, then about the new x (n, 4)."""
    zero = np.zeros(len(yaw))
    parts = []
    for axis, angle in ((2, yaw), (1, pitch), (0, roll)):
        rows = [np.cos(angle / 2), zero, zero, zero]
        rows[axis + 1] = np.sin(angle / 2)
        parts.append(np.column_stack(rows))
    return multiply(multiply(parts[0], parts[1]), parts[2])


def _rates(yaw: Motion, pitch: Motion, roll: Motion) -> tuple[Array, Array]:
    """Rate of the carriage in its own frame, and its time derivative (n, 3) each."""
    sp, cp = np.sin(pitch.place), np.cos(pitch.place)
    sr, cr = np.sin(roll.place), np.cos(roll.place)
    dy, dp, dr = yaw.rate, pitch.rate, roll.rate
    ay, ap, ar = yaw.acceleration, pitch.acceleration, roll.acceleration
    rate = np.column_stack((dr - dy * sp, dp * cr + dy * cp * sr, dy * cp * cr - dp * sr))
    growth = np.column_stack(
        (
            ar - ay * sp - dy * dp * cp,
            ap * cr - dp * dr * sr + ay * cp * sr - dy * dp * sp * sr + dy * dr * cp * cr,
            ay * cp * cr - dy * dp * sp * cr - dy * dr * cp * sr - ap * sr - dp * dr * cr,
        )
    )
    return rate, growth
