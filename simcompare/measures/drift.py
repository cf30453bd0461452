"""A path on the ground: its length, and how far its end and its points are from the true path."""

from __future__ import annotations

import numpy as np

from simcompare.measures import Measured, Pairs, Request, _window
from simcompare.model.trajectory import Trajectory

#: series along the path; the values that judge come only from a comparison
SERIES = ("path_time", "path_x", "path_y")
ROLES = ("side",)
OPTIONS = ("count",)
AXES = {"path_x": "path_time", "path_y": "path_x"}
UNITS = {
    "path_time": "s",
    "path_x": "m",
    "path_y": "m",
    "path_length": "m",
    "end_error": "m",
    "largest_error": "m",
    "end_drift": "1",
}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Length of the whole path, and evenly spaced points of it, the first and the last included.

    Args:
        trajectory: the source.
        request: its probe sees one coordinate on the ground, its role ``side`` the other one; its
            option ``count`` is the number of points wanted.

    Returns:
        ``path_length``, the sum of the distances between samples, and the points.
    """
    x, y = request.observed(trajectory), request.observed(trajectory, "side")
    taken = _window.evenly(len(x), request.options["count"])
    return Measured(
        values={"path_length": float(np.hypot(np.diff(x), np.diff(y)).sum())},
        series={"path_time": trajectory.time_s[taken], "path_x": x[taken], "path_y": y[taken]},
    )


def against(measured: Measured, truth: Measured) -> Pairs:
    """What is judged, where both were sampled at the same times.

    That is ``path_length`` beside the true one, and against 0: ``largest_error``, the largest
    distance between the two at the points, ``end_error``, that of their ends, and ``end_drift``,
    the latter over the length of the true path.
    """
    length = truth.values["path_length"]
    assert length is not None
    pairs: Pairs = {"path_length": (measured.values["path_length"], length)}
    if not _window.same(measured.series["path_time"], truth.series["path_time"]):
        return {**pairs, "end_error": (None, 0.0), "largest_error": (None, 0.0)}
    apart = np.hypot(
        measured.series["path_x"] - truth.series["path_x"],
        measured.series["path_y"] - truth.series["path_y"],
    )
    end = float(apart[-1])
    pairs |= {"end_error": (end, 0.0), "largest_error": (float(apart.max()), 0.0)}
    if length > 0:
        pairs["end_drift"] = (end / length, 0.0)
    return pairs
