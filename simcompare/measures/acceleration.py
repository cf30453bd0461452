"""Acceleration over a window of time, from positions alone."""

from __future__ import annotations

import numpy as np

from simcompare.measures import Measured, Request, _window
from simcompare.model.trajectory import Array, Trajectory

#: a parabola has three coefficients; fewer samples than twice that are not smoothed
MIN_SAMPLES = 6

OPTIONS = ("start_s", "end_s")
UNITS = {"acceleration": "m/s²"}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Twice the leading coefficient of the parabola that fits the positions best.

    Stored velocities are not used: an engine may hold them half a step away from the positions.

    Args:
        trajectory: the source.
        request: its probe sees one coordinate of a position; its options bound the window [s].

    Returns:
        ``acceleration``, ``None`` where the window holds fewer than six samples.
    """
    inside = _window.samples(trajectory.time_s, request.options)
    time_s, position = trajectory.time_s[inside], request.observed(trajectory)[inside]
    acceleration = _fit(time_s, position) if len(time_s) >= MIN_SAMPLES else None
    return Measured(values={"acceleration": acceleration})


def _fit(time_s: Array, position_m: Array) -> float:
    """Acceleration of the best parabola; times are scaled to -1 … 1, where it is well posed."""
    half_s = (time_s[-1] - time_s[0]) / 2
    scaled = (time_s - time_s[0]) / half_s - 1
    return float(2 * np.polyfit(scaled, position_m - position_m[0], 2)[0] / half_s**2)
