"""Force that holds a mass at rest on a tilted base: gravity turned into the base's frame.

Turned by θ about +y, which points to the left, the base's rotation to the world is
R = [[cos θ, 0, sin θ], [0, 1, 0], [-sin θ, 0, cos θ]]; its front goes down. The specific force at
rest is g up in the world, and in the base's frame Rᵀ·(0, 0, g) = g·(-sin θ, 0, cos θ).
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Force on the mass in its frame, ``cell.force_N`` (n, 3), the same at all times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times (n,) [s].
    """
    tilt = parameters["tilt_rad"]
    weight = parameters["seismic_mass_kg"] * parameters["gravity_m_s2"]
    force = weight * np.array((-math.sin(tilt), 0.0, math.cos(tilt)))
    return {"cell.force_N": np.tile(force, (len(time_s), 1))}
