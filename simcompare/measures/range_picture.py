"""The whole picture of a range sensor of many zones, held against the true one."""

from __future__ import annotations

import numpy as np

from simcompare.measures import Measured, Pairs, Request, _window, side_by_side
from simcompare.model.trajectory import Trajectory

#: a zone that is further off than this sees something else [m]
WRONG_M = 0.01
SERIES = ("picture_time", "nearest_range")
OPTIONS = ("count",)
AXES = {"nearest_range": "picture_time"}
UNITS = {"picture_time": "s", "nearest_range": "m", "nearest": "m", "range_error": "m",
         "share_of_wrong_readings": "1"}  # fmt: skip


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """How near anything comes, in evenly spaced pictures.

    Args:
        trajectory: the source.
        request: its probe sees any zone of the sensor; all of them are used. Its option ``count``
            is the number of evenly spaced samples.

    Returns:
        ``nearest``, the least range of all zones in all of these pictures, and ``nearest_range``
        in each of them.
    """
    request.observed(trajectory)  # says where there is no such signal
    pictures = trajectory.signals[request.probe.observe]
    taken = _window.evenly(len(pictures), request.options["count"])
    chosen = pictures[taken]
    return Measured(
        values={"nearest": float(chosen.min())},
        series={"picture_time": trajectory.time_s[taken], "nearest_range": chosen.min(axis=1)},
        compared={"pictures": chosen},
    )


def against(measured: Measured, truth: Measured) -> Pairs:
    """What is judged: ``nearest``, ``range_error`` and ``share_of_wrong_readings``.

    ``range_error`` is the largest deviation of any zone in any of the pictures,
    ``share_of_wrong_readings`` the part of all that are off by more than a centimetre. Both are
    unknown (``None``) where the two have other samples.
    """
    judged = side_by_side(measured, truth)
    if not _window.same(measured.series["picture_time"], truth.series["picture_time"]):
        return {**judged, "range_error": (None, 0.0), "share_of_wrong_readings": (None, 0.0)}
    off = np.abs(measured.compared["pictures"] - truth.compared["pictures"]).ravel()
    return {
        **judged,
        "range_error": (_window.largest(off), 0.0),
        "share_of_wrong_readings": (float(np.mean(off > WRONG_M)), 0.0),
    }
