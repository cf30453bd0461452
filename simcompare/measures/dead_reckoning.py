"""Dead reckoning of a source's own encoders, and how far it ends from that source's own place.

Odometry believes two equal wheels and a track. Both the marks and the true place are of the same
source, so what is found is the error of odometry alone, and sources can be compared in it.
"""

from __future__ import annotations

import math

import numpy as np

from simcompare.hardware.sensors import odometer
from simcompare.measures import Measured, Request, _window
from simcompare.measures.heading import yaw_of
from simcompare.model.trajectory import Array, Trajectory

SERIES = ("reckoned_time", "reckoned_x", "reckoned_y")
ROLES = ("side", "orientation", "left_marks", "right_marks")
OPTIONS = ("radius_m", "track_m", "marks", "count")
AXES = {"reckoned_x": "reckoned_time", "reckoned_y": "reckoned_x"}
UNITS = {
    "reckoned_time": "s",
    "reckoned_x": "m",
    "reckoned_y": "m",
    "odometry_error": "m",
    "odometry_along": "m",
    "odometry_across": "m",
    "odometry_turn": "rad",
    "odometry_drift": "1",
}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Odometry less truth at the end of the record.

    Args:
        trajectory: the source.
        request: its probe sees the place along x, its role ``side`` that along y, ``orientation``
            any component of the body's orientation, ``left_marks`` and ``right_marks`` the whole
            marks that have passed. Options: ``radius_m`` and ``track_m`` as odometry believes them,
            ``marks`` in one turn of a wheel, and how many points of the path are wanted, ``count``.

    Returns:
        ``odometry_error`` (the distance), ``odometry_along`` and ``odometry_across`` (in the
        direction that odometry heads at last, and to the left of it), ``odometry_turn`` (its
        heading less the true one), ``odometry_drift`` (the distance over the length of the path;
        ``None`` where nothing moved), and points of its path.
    """
    place = np.column_stack((request.observed(trajectory), request.observed(trajectory, "side")))
    yaw = yaw_of(trajectory.signals[request.also["orientation"].observe])
    pose = _reckoned(trajectory, request, (float(place[0, 0]), float(place[0, 1]), float(yaw[0])))
    apart, heading = pose[-1, :2] - place[-1], pose[-1, 2]
    length = float(np.hypot(*np.diff(place, axis=0).T).sum())
    error = float(np.hypot(*apart))
    taken = _window.evenly(len(place), request.options["count"])
    return Measured(
        values={
            "odometry_error": error,
            "odometry_along": float(apart @ (math.cos(heading), math.sin(heading))),
            "odometry_across": float(apart @ (-math.sin(heading), math.cos(heading))),
            "odometry_turn": float(heading - yaw[-1]),
            "odometry_drift": error / length if length > 0 else None,
        },
        series={
            "reckoned_time": trajectory.time_s[taken],
            "reckoned_x": pose[taken, 0],
            "reckoned_y": pose[taken, 1],
        },
    )


def _reckoned(trajectory: Trajectory, request: Request, start: tuple[float, float, float]) -> Array:
    """Pose (n, 3) by the marks of both wheels."""
    per_mark = 2 * math.pi * request.options["radius_m"] / request.options["marks"]
    left, right = (
        per_mark * request.observed(trajectory, role) for role in ("left_marks", "right_marks")
    )
    return odometer.poses(odometer.arcs(left, right, request.options["track_m"], start[2]), start)
