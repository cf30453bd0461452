"""A probe over time at evenly spaced samples, and how far it strays from the truth there."""

from __future__ import annotations

from simcompare.measures import OF_PROBE, Measured, Pairs, Request, _window
from simcompare.model.trajectory import Trajectory

#: series over time; the value comes only from a comparison
SERIES = ("time", "history")
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
        series={"time": trajectory.time_s[taken], "history": request.observed(trajectory)[taken]},
    )


def against(measured: Measured, truth: Measured) -> Pairs:
    """What is judged: ``history_error``, the largest deviation from the truth at these samples.

    It is unknown (``None``) where the two were not sampled at the same times.
    """
    if not _window.same(measured.series["time"], truth.series["time"]):
        return {"history_error": (None, 0.0)}
    errors = measured.series["history"] - truth.series["history"]
    return {"history_error": (_window.largest(errors), 0.0)}
