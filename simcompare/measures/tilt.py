"""Tilt of a sensor at rest from its three readings of gravity."""

from __future__ import annotations

import math

from simcompare.measures import Measured, Request
from simcompare.model.trajectory import Trajectory

ROLES = ("left", "up")
UNITS = {"pitch": "rad", "roll": "rad"}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Pitch and roll from the mean readings of all samples.

    At rest a sensor that is first pitched by θ about y (left; its front goes down), then rolled by
    φ about its own x axis (forward), reads f = g·(-sin θ, sin φ·cos θ, cos φ·cos θ). So
    θ = atan2(-f_x, √(f_y² + f_z²)) and φ = atan2(f_y, f_z). A common scale of the readings cancels.

    Args:
        trajectory: the source, at rest.
        request: its probe sees the reading forward, its roles ``left`` and ``up`` the other two,
            in the same unit.

    Returns:
        ``pitch`` and ``roll``; ``None`` where there is no reading at all.
    """
    forward = float(request.observed(trajectory).mean())
    left, up = (float(request.observed(trajectory, role).mean()) for role in ROLES)
    reads = math.hypot(forward, left, up) > 0
    return Measured(
        values={
            "pitch": math.atan2(-forward, math.hypot(left, up)) if reads else None,
            "roll": math.atan2(left, up) if reads else None,
        }
    )
