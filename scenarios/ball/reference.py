"""Closed form of the bouncing ball: Newton restitution, in vacuum or with quadratic air drag.

Vacuum: free fall and e·v at each impact. Drag c·v² with v_t = √(m·g/c): falling from rest by s,
v = v_t·√(1 - exp(-2gs/v_t²)) and z(t) = h - (v_t²/g)·ln cosh(g·t/v_t); rising from speed u,
v = v_t·tan(φ - g·t/v_t) with φ = arctan(u/v_t) and z(t) = (v_t²/g)·ln(cos(φ - g·t/v_t)/cos φ).
Source: Timmerman and van der Weele, Am. J. Phys. 67 (1999) 538; checked in the tests against an
independent integration (DOP853) to 1e-9.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array

#: flights shorter than this part of the first fall are not resolved; the ball is at rest
SHORTEST_FLIGHT = 1e-9


@dataclass(frozen=True)
class Flight:
    """One flight from impact (or release) to impact.

    Attributes:
        start_s: when it leaves the floor (for the first: when it would have, before the release)
        [s]. apex_s: when it is highest [s]. apex_m: how high [m]. end_s: when it hits the floor
        [s].
    """

    start_s: float
    apex_s: float
    apex_m: float
    end_s: float


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Position and velocity of the ball at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from release on (n,) [s].

    Returns:
        ``ball.position_m`` (n, 3) and ``ball.velocity_m_s`` (n, 3), world frame.
    """
    height, velocity = np.zeros(len(time_s)), np.zeros(len(time_s))
    terminal = terminal_speed(parameters)
    gravity = parameters["gravity_m_s2"]
    for flight in flights(parameters, float(time_s[-1])):
        inside = (time_s >= flight.start_s) & (time_s < flight.end_s)
        from_apex = time_s[inside] - flight.apex_s
        height[inside], velocity[inside] = _free(from_apex, flight.apex_m, gravity, terminal)
    zero = np.zeros(len(time_s))
    return {
        "ball.position_m": np.column_stack((zero, zero, height + parameters["radius_m"])),
        "ball.velocity_m_s": np.column_stack((zero, zero, velocity)),
    }


def flights(parameters: Mapping[str, float], until_s: float) -> list[Flight]:
    """All flights that begin before ``until_s``, the first one beginning at its apex at time 0."""
    gravity, e = parameters["gravity_m_s2"], parameters["restitution"]
    terminal = terminal_speed(parameters)
    apex = parameters["drop_height_m"]
    fall, speed = _fall(apex, gravity, terminal)
    flown = [Flight(-fall, 0.0, apex, fall)]
    shortest = SHORTEST_FLIGHT * fall
    while flown[-1].end_s < until_s:
        start = flown[-1].end_s
        rise, apex = _rise(e * speed, gravity, terminal)
        fall, speed = _fall(apex, gravity, terminal)
        if rise + fall < shortest:
            break
        flown.append(Flight(start, start + rise, apex, start + rise + fall))
    return flown


def terminal_speed(parameters: Mapping[str, float]) -> float:
    """v_t = √(m·g/c) with c = ½·ρ·C_d·π·r² [m/s]; infinite in vacuum."""
    area = math.pi * parameters["radius_m"] ** 2
    drag = 0.5 * parameters["air_density_kg_m3"] * parameters["drag_coefficient"] * area
    if drag == 0:
        return math.inf
    return math.sqrt(parameters["mass_kg"] * parameters["gravity_m_s2"] / drag)


def _fall(height_m: float, gravity: float, terminal: float) -> tuple[float, float]:
    """Duration and final speed of a fall from rest."""
    if math.isinf(terminal):
        return math.sqrt(2 * height_m / gravity), math.sqrt(2 * gravity * height_m)
    scaled = gravity * height_m / terminal**2
    speed = terminal * math.sqrt(-math.expm1(-2 * scaled))
    return terminal / gravity * math.atanh(speed / terminal), speed


def _rise(speed: float, gravity: float, terminal: float) -> tuple[float, float]:
    """Duration and height of a rise."""
    if math.isinf(terminal):
        return speed / gravity, speed**2 / (2 * gravity)
    height = terminal**2 / (2 * gravity) * math.log1p((speed / terminal) ** 2)
    return terminal / gravity * math.atan(speed / terminal), height


def _free(
    from_apex_s: Array, apex_m: float, gravity: float, terminal: float
) -> tuple[Array, Array]:
    """Height and velocity at times before (negative) and after the apex."""
    if math.isinf(terminal):
        return apex_m - 0.5 * gravity * from_apex_s**2, -gravity * from_apex_s
    x = gravity * from_apex_s / terminal
    scale = terminal**2 / gravity
    rising, falling = np.minimum(x, 0.0), np.maximum(x, 0.0)
    # ln cosh x without overflow: |x| + ln((1 + e^(-2|x|))/2)
    drop = falling + np.log1p(np.exp(-2 * falling)) - math.log(2.0)
    height = apex_m + scale * (np.log(np.cos(rising)) - drop)
    velocity = terminal * (-np.tan(rising) - np.tanh(falling))
    return height, velocity
