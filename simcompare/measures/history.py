"""A probe over time at evenly spaced samples, and how far it strays from the truth there."""

from __future__ import annotations

import numpy as np

from simcompare.measures import OF_PROBE, Measured, Request, _window
from simcompare.model.trajectory import Trajectory

#: series over time; the value comes only from a comparison
SERIES = ("time", "history")
ROLES: tuple[str, ...] = ()
OPTIONS = ("count",)
AXES = {"history": "time"}
UNITS = {"time": "s", "history": OF_PROBE, "history_error": OF_PROBE}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Samples of the probe, as evenly spaced as the record allows, the first and the last included.

    Args:
        trajectory: the source.
        request: its probe sees the quantity; its option ``count`` is the number of samples wanted.

    Returns:
        Series ``time`` and ``history``; fewer than ``count`` where the record is shorter.
    """
    taken = _window.evenly(len(trajectory.time_s), request.options["count"])
    return Measured(
        values={},
        series={"time": trajectory.time_s[taken], "history": request.seen(trajectory)[taken]},
        units=UNITS,
    )


def against(measured: Measured, truth: Measured) -> dict[str, tuple[float | None, float]]:
    """What is judged: ``history_error``, the largest deviation from the truth at these samples.

    It is unknown (``None``) where the two were not sampled at the same times.
    """
    ours, theirs = measured.series["time"], truth.series["time"]
    if len(ours) != len(theirs) or not np.allclose(ours, theirs, rtol=1e-9, atol=1e-12):
        return {"history_error": (None, 0.0)}
    deviation = np.abs(measured.series["history"] - truth.series["history"])
    return {"history_error": (float(deviation.max()), 0.0)}
