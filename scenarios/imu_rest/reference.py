"""A device at rest: its sensors read g upwards, turned into their frame, and no rate.

A sensor that is pitched by θ about y (to the left; its front goes down), then rolled by φ about its
own x axis, has the rotation R = R_y(θ)·R_x(φ) to the world. At rest its specific force is
Rᵀ·(0, 0, g) = g·(-sin θ, sin φ·cos θ, cos φ·cos θ). The rate of the Earth, 7.292e-5 rad/s, is left
out: it is a hundredth of the offset of a good cheap gyroscope.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.body_signals import unturned


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Both devices, their sensors and the force of the floor, the same at all times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times (n,) [s].
    """
    count = len(time_s)
    gravity = parameters["gravity_m_s2"]

    def always(*values: float) -> Array:
        return np.tile(np.array(values), (count, 1))

    signals = {
        "accelerometer.specific_force_m_s2": always(*specific_force_m_s2(parameters)),
        "gyroscope.rate_rad_s": always(0.0, 0.0, 0.0),
        "level.specific_force_m_s2": always(0.0, 0.0, gravity),
        "lying_accelerometer.specific_force_m_s2": always(0.0, 0.0, gravity),
        "support.normal_force_N": np.full(count, parameters["device_mass_kg"] * gravity),
    }
    for body, height in (("held", 10.0), ("lying", 0.5)):
        place = always(0.0, 0.0, height * parameters["device_height_m"])
        signals |= unturned(body, place, always(0.0, 0.0, 0.0))
    return signals


def specific_force_m_s2(parameters: Mapping[str, float]) -> tuple[float, float, float]:
    """What the accelerometer reads along its x, y and z axes."""
    roll, pitch = parameters["roll_rad"], parameters["pitch_rad"]
    g = parameters["gravity_m_s2"]
    level = g * math.cos(pitch)
    return -g * math.sin(pitch), level * math.sin(roll), level * math.cos(roll)
