"""Exact motion of a pendulum of two links with viscous friction in both hinges.

With θ₁, θ₂ the angles of the links from hanging, A₁ = I₁ + m₁·a₁² + m₂·L², A₂ = I₂ + m₂·a₂² and
C = m₂·L·a₂ (L from hinge to hinge, a from its hinge to a link's centre of mass, I about that),
Lagrange's equations are

    A₁·θ̈₁ + C·cos(θ₁-θ₂)·θ̈₂ = -C·sin(θ₁-θ₂)·θ̇₂² - (m₁·a₁ + m₂·L)·g·sin θ₁ - b₁·θ̇₁ - b₂·(θ̇₁-θ̇₂)
    A₂·θ̈₂ + C·cos(θ₁-θ₂)·θ̈₁ = C·sin(θ₁-θ₂)·θ̇₁² - m₂·a₂·g·sin θ₂ + b₂·(θ̇₁-θ̇₂)

(Landau and Lifshitz, Mechanics, §5, problem 1, for rigid links). They are solved as for the single
pendulum: by Taylor series from step to step, whose coefficients follow from those of the sines,
of the products, and of the quotient by the determinant. That is exact to rounding, which the
motion itself multiplies by ten every 0.8 s or so at large angles.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from operator import mul

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.pendulum.reference import TERMS, evaluated, reach, value_at

#: longest step [s] for links that fall within 1/ω = 1 s
LONGEST_STEP = 0.5


@dataclass(frozen=True)
class Links:
    """Constants of the equations of motion.

    Attributes:
        inertia: A₁, A₂ and C [kg·m²].
        weight: torque of the weight for sin θ = 1, of either link [N·m].
        damping: b₁ and b₂ [N·m·s/rad].
    """

    inertia: tuple[float, float, float]
    weight: tuple[float, float]
    damping: tuple[float, float]


def links_of(parameters: Mapping[str, float]) -> Links:
    """The links of a scenario's parameters."""
    upper, lower = parameters["upper_mass_kg"], parameters["lower_mass_kg"]
    upper_center, lower_center = parameters["upper_center_m"], parameters["lower_center_m"]
    length, gravity = parameters["upper_length_m"], parameters["gravity_m_s2"]
    return Links(
        inertia=(
            parameters["upper_inertia_kg_m2"] + upper * upper_center**2 + lower * length**2,
            parameters["lower_inertia_kg_m2"] + lower * lower_center**2,
            lower * length * lower_center,
        ),
        weight=((upper * upper_center + lower * length) * gravity, lower * lower_center * gravity),
        damping=(
            parameters["upper_damping_N_m_s_rad"],
            parameters["lower_damping_N_m_s_rad"],
        ),
    )


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of both links at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on, growing (n,) [s].

    Returns:
        Coordinates (0 at the start) and rates of both hinges, each (n,).
    """
    angles, rates = motion(parameters, time_s)
    start = parameters["lower_angle_rad"] - parameters["upper_angle_rad"]
    return {
        "shoulder.angle_rad": angles[0] - parameters["upper_angle_rad"],
        "shoulder.rate_rad_s": rates[0],
        "elbow.angle_rad": angles[1] - angles[0] - start,
        "elbow.rate_rad_s": rates[1] - rates[0],
    }


def motion(parameters: Mapping[str, float], time_s: Array) -> tuple[Array, Array]:
    """Angles from hanging and rates (2, n) of both links."""
    links = links_of(parameters)
    angles = [parameters["upper_angle_rad"], parameters["lower_angle_rad"]]
    rates = [parameters["upper_rate_rad_s"], parameters["lower_rate_rad_s"]]
    quickest = max(w / a for w, a in zip(links.weight, links.inertia[:2], strict=True))
    until_s = float(time_s[-1]) if len(time_s) else 0.0
    time, starts, series = 0.0, [], []
    while True:
        both = _taylor(links, angles, rates)
        starts.append(time)
        series.append(both)
        step = min(*map(reach, both), LONGEST_STEP / math.sqrt(quickest))
        (angles[0], rates[0]), (angles[1], rates[1]) = (value_at(one, step) for one in both)
        time += step
        if time > until_s:
            break
    links_of_steps = np.array(series).transpose(1, 2, 0)
    links_at = [evaluated(link, np.array(starts), time_s) for link in links_of_steps]
    return np.array([angle for angle, _ in links_at]), np.array([rate for _, rate in links_at])


class _Sine:
    """Series of sine and cosine of an angle, from the series of its rate."""

    def __init__(self, angle: float) -> None:
        self.sine = [math.sin(angle)]
        self.cosine = [math.cos(angle)]

    def grow(self, rate: list[float]) -> None:
        """One more coefficient; the rate has as many as the sine has now."""
        n = len(self.sine)
        more = _times(rate, self.cosine) / n, -_times(rate, self.sine) / n
        self.sine.append(more[0])
        self.cosine.append(more[1])


def _times(first: list[float], second: list[float]) -> float:
    """Last coefficient of the product of two series with as many coefficients."""
    return float(sum(map(mul, first, reversed(second))))


def _taylor(
    links: Links, angles: list[float], rates: list[float]
) -> tuple[list[float], list[float]]:
    """Coefficients of both angles as series in time."""
    first, second, coupling = links.inertia
    upper, lower = [angles[0], rates[0]], [angles[1], rates[1]]
    p, q = [rates[0]], [rates[1]]
    turned, hung, apart = _Sine(angles[0]), _Sine(angles[1]), _Sine(angles[0] - angles[1])
    between = [rates[0] - rates[1]]
    # squares of the rates, C·cos, the right-hand sides, the determinant and both accelerations
    p_p: list[float] = []
    q_q: list[float] = []
    c: list[float] = []
    right: tuple[list[float], list[float]] = ([], [])
    determinant: list[float] = []
    accelerations: tuple[list[float], list[float]] = ([], [])
    for n in range(1, TERMS - 1):
        p_p.append(_times(p, p))
        q_q.append(_times(q, q))
        c.append(coupling * apart.cosine[-1])
        held = links.damping[1] * between[-1]
        right[0].append(
            -coupling * _times(apart.sine, q_q)
            - links.weight[0] * turned.sine[-1]
            - links.damping[0] * p[-1]
            - held
        )
        right[1].append(coupling * _times(apart.sine, p_p) - links.weight[1] * hung.sine[-1] + held)
        determinant.append((first * second if n == 1 else 0.0) - _times(c, c))
        over = (
            second * right[0][-1] - _times(c, right[1]),
            first * right[1][-1] - _times(c, right[0]),
        )
        for top, quotient in zip(over, accelerations, strict=True):
            quotient.append((top - _times(determinant[1:], quotient)) / determinant[0])
        for sine, rate in ((turned, p), (hung, q), (apart, between)):
            sine.grow(rate)
        p.append(accelerations[0][-1] / n)
        q.append(accelerations[1][-1] / n)
        between.append(p[-1] - q[-1])
        upper.append(p[-1] / (n + 1))
        lower.append(q[-1] / (n + 1))
    return upper, lower
