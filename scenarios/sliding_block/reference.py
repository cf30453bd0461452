"""Closed form of a block that slides on a plane with Coulomb friction.

Along the plane, downhill positive, a = g·(sin α - μ·cos α·sgn v). Where it stops it stays if
tan α ≤ μ, and slides down with a = g·(sin α - μ·cos α) otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.body_signals import unturned


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the block at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start (n,) [s].

    Returns:
        Position, velocity, orientation and rate of the block.
    """
    moved, speed = motion(parameters, time_s)
    zero = np.zeros(len(time_s))
    height = np.full(len(time_s), parameters["height_m"] / 2)
    position = np.column_stack((parameters["start_position_m"] + moved, zero, height))
    return unturned("block", position, np.column_stack((speed, zero, zero)))


def motion(parameters: Mapping[str, float], time_s: Array) -> tuple[Array, Array]:
    """Way since the start [m] and speed [m/s] at the given times (n,)."""
    angle, g = parameters["incline_rad"], parameters["gravity_m_s2"]
    pull, brake = g * math.sin(angle), parameters["friction"] * g * math.cos(angle)
    speed = parameters["start_speed_m_s"]
    way = math.copysign(1.0, speed) if speed else 1.0
    first = pull - way * brake
    # a block that is pushed down a steep plane never stops
    stops = -speed / first if speed * first < 0 else (math.inf if speed else 0.0)
    before = np.minimum(time_s, stops)
    after = np.maximum(time_s - stops, 0.0)
    second = max(pull - brake, 0.0)
    moved = speed * before + first * before**2 / 2 + second * after**2 / 2
    faded = np.where(time_s < stops, speed + first * before, second * after)
    return np.asarray(moved, dtype=float), np.asarray(faded, dtype=float)
