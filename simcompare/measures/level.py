"""Mean of a probe over a window of time: a level that something has settled at."""

from __future__ import annotations

from simcompare import measures
from simcompare.measures import OF_PROBE, Measured, Request
from simcompare.trajectory import Trajectory

#: sample times are multiples of a step, and a window's edge may miss one by rounding only
ROUNDING = 1e-9

SERIES: tuple[str, ...] = ()
ROLES: tuple[str, ...] = ()
OPTIONS = ("start_s", "end_s")
AXES: dict[str, str] = {}
UNITS = {"mean": OF_PROBE}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Mean of all samples from ``start_s`` to ``end_s``, both included.

    Args:
        trajectory: the source.
        request: its probe sees the quantity; its options bound the window [s].

    Returns:
        ``mean``, ``None`` where the window holds no sample.
    """
    time_s, values = trajectory.time_s, request.seen(trajectory)
    start_s, end_s = request.options["start_s"], request.options["end_s"]
    slack_s = ROUNDING * max(abs(start_s), abs(end_s))
    inside = values[(time_s >= start_s - slack_s) & (time_s <= end_s + slack_s)]
    mean = float(inside.mean()) if len(inside) else None
    return Measured(values={"mean": mean}, series={}, units=UNITS)


def against(measured: Measured, truth: Measured) -> dict[str, tuple[float | None, float]]:
    """What is judged: the mean beside the true one."""
    return measures.side_by_side(measured, truth)
