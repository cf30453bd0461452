"""Mean of a probe over a window of time: a level that something has settled at."""

from __future__ import annotations

from simcompare.measures import OF_PROBE, Measured, Request, _window
from simcompare.model.trajectory import Trajectory

OPTIONS = ("start_s", "end_s")
UNITS = {"mean": OF_PROBE}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Mean of all samples from ``start_s`` to ``end_s``, both included.

    Args:
        trajectory: the source.
        request: its probe sees the quantity; its options bound the window [s].

    Returns:
        ``mean``, ``None`` where the window holds no sample.
    """
    inside = request.observed(trajectory)[_window.samples(trajectory.time_s, request.options)]
    mean = float(inside.mean()) if len(inside) else None
    return Measured(values={"mean": mean})
