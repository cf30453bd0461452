"""Closed form of what each zone of the sensor sees: a wall, a floor, a ball and a crate.

The cart moves by v·t. A zone in row r from the top and column c from the left looks along
(1, tan α, tan β), α = (3.5 - c)·5.625° to the left and β = (3.5 - r)·5.625° upwards. With x, the
way along the axis, as the parameter of that ray, the wall is met at D·cos ψ/(cos ψ + tan α·sin ψ),
the floor at -h/tan β, the ball at the smaller root of a quadratic, and the crate where the ray has
entered all three pairs of its planes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array

#: from the cart to the sensor, its reach, and the width of a zone
AHEAD_M, REACH_M, ZONE_RAD = 0.05, 4.0, math.radians(5.625)
#: where the ball is above the sensor's height, and the crate: its middle and half its edges
BALL_M = (0.9, 0.2, 0.12)
CRATE_M, CRATE_HALF_M = (1.1, -0.28, 0.1), (0.1, 0.08, 0.1)


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the cart, and what the sensor reads.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].

    Returns:
        ``way.position_m`` and ``way.velocity_m_s`` (n,), and ``eye.range_m`` (n, 64).
    """
    way = parameters["speed_m_s"] * time_s
    eye = np.column_stack(
        (way + AHEAD_M, np.zeros(len(way)), np.full(len(way), height(parameters)))
    )
    return {
        "way.position_m": way,
        "way.velocity_m_s": np.full(len(way), parameters["speed_m_s"]),
        "eye.range_m": ranges(parameters, eye),
    }


def height(parameters: Mapping[str, float]) -> float:
    """Of the sensor above the floor [m]."""
    return parameters["height_m"]


def ranges(parameters: Mapping[str, float], eye_m: Array) -> Array:
    """Ranges (n, 64) [m] from where the sensor is (n, 3), looking along x."""
    angle = (3.5 - np.arange(8)) * ZONE_RAD
    up, left = (part.ravel() for part in np.meshgrid(np.tan(angle), np.tan(angle), indexing="ij"))
    turn, (x, _, z) = parameters["wall_turn_rad"], eye_m.T[:, :, None]
    wall = (parameters["wall_m"] - x) / (1 + left * math.tan(turn))
    with np.errstate(divide="ignore"):
        floor = np.where(up < 0, -z / up, np.inf)
    ball = _ball(eye_m, left, up, parameters)
    crate = _crate(eye_m, left, up)
    seen = (wall, floor, ball, crate, np.full(wall.shape, REACH_M))
    return np.asarray(np.min(seen, axis=0), dtype=float)


def _ball(eye_m: Array, left: Array, up: Array, parameters: Mapping[str, float]) -> Array:
    above = height(parameters) + BALL_M[2]
    x, y, z = (np.array([BALL_M[0], BALL_M[1], above]) - eye_m).T[:, :, None]
    a = 1 + left**2 + up**2
    b = x + y * left + z * up
    root = b**2 - a * (x**2 + y**2 + z**2 - parameters["ball_radius_m"] ** 2)
    met = (b - np.sqrt(np.maximum(root, 0))) / a
    return np.where((root >= 0) & (met >= 0), met, np.inf)


def _crate(eye_m: Array, left: Array, up: Array) -> Array:
    """The last of the planes that are entered, before the first that is left."""
    enters, leaves = [], []
    for i, along in enumerate((np.ones(len(left)), left, up)):
        middle = (CRATE_M[i] - eye_m[:, i, None]) / along
        half = CRATE_HALF_M[i] / np.abs(along)
        enters.append(middle - half)
        leaves.append(middle + half)
    first, last = np.maximum.reduce(enters), np.minimum.reduce(leaves)
    return np.where((first <= last) & (first >= 0), first, np.inf)
