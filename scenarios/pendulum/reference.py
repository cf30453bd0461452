"""Exact motion of a rigid pendulum with viscous and dry friction in its hinge.

With θ the angle from hanging, ω₀² = g/L, c = b/I and f = F/I (I about the hinge) the motion follows

    θ̈ = -ω₀²·sin θ - c·θ̇ - f·sgn θ̇,

and it stays where it turns if ω₀²·|sin θ| ≤ f there. Between two turning points the right-hand side
is analytic, so the solution is developed into its Taylor series from step to step (Jorba and Zou,
Experimental Mathematics 14, 2005, 99): with s = sin θ and k = cos θ the coefficients follow from
s' = k·θ̇ and k' = -s·θ̇. The series is the solution between the steps as well, turning points are
roots of its derivative, and with 26 terms all of it is exact to rounding.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from operator import mul

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.instants import piece_at

#: terms of a series
TERMS = 26
#: what the last terms may add to the angle [rad]
LEFT_OUT_RAD = 1e-17
#: longest step in units of 1/ω₀: far less than half a swing, so that no two turns are in one
LONGEST_STEP = 0.8


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the pendulum at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on, growing (n,) [s].

    Returns:
        Coordinate (0 at the start) and rate of the hinge, each (n,).
    """
    angle, rate = motion(parameters, time_s)
    return {"hinge.angle_rad": angle - parameters["start_angle_rad"], "hinge.rate_rad_s": rate}


def inertia_kg_m2(parameters: Mapping[str, float]) -> float:
    """Moment of inertia about the hinge, m·d·L with the centre of mass at d."""
    length = parameters["length_m"]
    return parameters["mass_kg"] * parameters["center_part"] * length * length


@dataclass(frozen=True)
class Law:
    """Constants of the equation of motion.

    Attributes:
        pull: ω₀² [1/s²].
        damping: c [1/s].
        friction: f [rad/s²]; where it is not 0, turning points are corners.
    """

    pull: float
    damping: float
    friction: float


def law_of(parameters: Mapping[str, float]) -> Law:
    """The law of a scenario's parameters."""
    inertia = inertia_kg_m2(parameters)
    return Law(
        pull=parameters["gravity_m_s2"] / parameters["length_m"],
        damping=parameters["damping_N_m_s_rad"] / inertia,
        friction=parameters["friction_N_m"] / inertia,
    )


def motion(parameters: Mapping[str, float], time_s: Array) -> tuple[Array, Array]:
    """Angle from hanging [rad] and rate [rad/s] at the given times (n,)."""
    starts, series = _developed(
        law_of(parameters),
        (parameters["start_angle_rad"], parameters["start_rate_rad_s"]),
        float(time_s[-1]) if len(time_s) else 0.0,
    )
    return evaluated(np.array(series).T, np.array(starts), time_s)


def _developed(
    law: Law, state: tuple[float, float], until_s: float
) -> tuple[list[float], list[list[float]]]:
    """Starts of all steps [s], and the coefficients of the angle from each of them on."""
    longest_s = LONGEST_STEP / math.sqrt(law.pull)
    time, starts, series = 0.0, [], []
    direction = _direction(law, state)
    while True:
        if law.friction and not direction:
            starts.append(time)
            series.append([state[0]] + [0.0] * (TERMS - 1))
            return starts, series
        coefficients = _taylor(law, state, direction)
        starts.append(time)
        series.append(coefficients)
        step = min(reach(coefficients), longest_s)
        after = value_at(coefficients, step)
        if law.friction and after[1] * direction <= 0:
            step = _turn(coefficients, step, direction)
            after = (value_at(coefficients, step)[0], 0.0)
            # what leaves its rest and is back at once has not left it
            direction = _direction(law, after) if step else 0
        state, time = after, time + step
        if time > until_s:
            return starts, series


def _direction(law: Law, state: tuple[float, float]) -> int:
    """Sign of the rate now or at once; 0 where it stays."""
    angle, rate = state
    if rate:
        return 1 if rate > 0 else -1
    pull = -law.pull * math.sin(angle)
    if abs(pull) <= law.friction:
        return 0
    return 1 if pull > 0 else -1


def _taylor(law: Law, state: tuple[float, float], direction: int) -> list[float]:
    """Coefficients of the angle as a series in time."""
    # the convolutions of the recurrence want the rate's coefficients backwards
    angle, rate = [state[0], state[1]], [state[1]]
    sines, cosines = [math.sin(state[0])], [math.cos(state[0])]
    for n in range(1, TERMS - 1):
        change = -law.pull * sines[-1] - law.damping * rate[0]
        if n == 1:
            change -= law.friction * direction
        s = sum(map(mul, cosines, rate)) / n
        c = -sum(map(mul, sines, rate)) / n
        sines.append(s)
        cosines.append(c)
        rate.insert(0, change / n)
        angle.append(change / (n * (n + 1)))
    return angle


def reach(coefficients: list[float]) -> float:
    """How far the series reaches before what is left out counts."""
    step = math.inf
    # several, for a single one may vanish by chance or by symmetry
    for order in range(TERMS - 4, TERMS):
        size = abs(coefficients[order])
        if size:
            step = min(step, (LEFT_OUT_RAD / size) ** (1 / order))
    return step


def value_at(coefficients: list[float], step: float) -> tuple[float, float]:
    """Angle and rate after a step, by Horner's rule."""
    angle = rate = 0.0
    for coefficient in reversed(coefficients):
        rate = rate * step + angle
        angle = angle * step + coefficient
    return angle, rate


def _turn(coefficients: list[float], step: float, direction: int) -> float:
    """Where the rate vanishes in a step at whose end it has the other sign: halving to rounding."""
    early, late = 0.0, step
    # rates are as good as straight here, so regula falsi (Illinois) needs a handful of steps
    before, behind = (
        value_at(coefficients, early)[1] * direction,
        value_at(coefficients, late)[1] * direction,
    )
    if before <= 0:
        return 0.0
    for _ in range(60):
        middle = late - behind * (late - early) / (behind - before)
        value = value_at(coefficients, middle)[1] * direction
        if value > 0:
            early, before, behind = middle, value, behind / 2
        else:
            late, behind, before = middle, value, before / 2
        if late - early <= 1e-15 or value == 0:
            return middle
    return late


def evaluated(series: Array, starts_s: Array, time_s: Array) -> tuple[Array, Array]:
    """Angles and rates from the coefficients (terms, steps), each sample in its own step."""
    place = piece_at(starts_s, time_s)
    since_s = time_s - starts_s[place]
    angle, rate = np.zeros(len(place)), np.zeros(len(place))
    for coefficients in series[::-1]:
        rate = rate * since_s + angle
        angle = angle * since_s + coefficients[place]
    return angle, rate
