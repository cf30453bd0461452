"""Heading of a body: how far it turns about the vertical."""

from __future__ import annotations

import numpy as np

from simcompare.measures import Measured, Request
from simcompare.model.trajectory import Array, Trajectory

UNITS = {"heading_drift": "rad", "heading_change": "rad"}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """The direction of the body's x axis on the ground, relative to where it pointed first.

    Args:
        trajectory: the source.
        request: its probe sees any component of the orientation of the body; all four are used.

    Returns:
        ``heading_drift``, the largest angle to either side, never below 0; ``heading_change``, the
        last angle, positive to the left, with whole turns counted.
    """
    yaw = yaw_of(trajectory.signals[request.probe.observe])
    turned = yaw - yaw[0]
    return Measured(
        values={
            "heading_drift": float(np.abs(turned).max()), "heading_change": float(turned[-1])
        }
    )  # fmt: skip


def yaw_of(orientation_wxyz: Array) -> Array:
    """Direction of the body's x axis on the ground, counted on through whole turns (n,) [rad]."""
    w, x, y, z = orientation_wxyz.T
    return np.unwrap(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y**2 + z**2)))


def wrapped(angle_rad: Array) -> Array:
    """The same angles between -π and π."""
    return np.asarray((angle_rad + np.pi) % (2 * np.pi) - np.pi, dtype=float)
