"""Speed of a shaft from an encoder: by counting marks in a gate, and by timing two marks.

Counting resolves 2π/(n·T), one mark in a gate of T, at any speed. Timing resolves the part
ω·n·δ/(2π) of the speed, δ being the tick of the clock. Both are held against the same source's own
motion, so what is found is the error of the encoder alone.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from simcompare.hardware.sensors import encoder
from simcompare.measures import Measured, Request, _window
from simcompare.model.trajectory import Array, Trajectory

SERIES = ("gate_time", "counted_speed", "mean_speed", "period_time", "timed_speed")
ROLES = ("angle",)
OPTIONS = ("marks", "gate_s", "tick_s")
AXES = {
    "counted_speed": "gate_time",
    "mean_speed": "gate_time",
    "timed_speed": "period_time",
}
UNITS = {
    "gate_time": "s",
    "counted_speed": "rad/s",
    "mean_speed": "rad/s",
    "period_time": "s",
    "timed_speed": "rad/s",
    "gate_resolution": "rad/s",
    "gate_uncertainty": "rad/s",
    "counting_error": "rad/s",
    "largest_counting_error": "rad/s",
    "largest_timing_error": "rad/s",
}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Speeds in gates that follow each other from the start of the record.

    Args:
        trajectory: the source.
        request: its probe sees the whole marks that have passed, its role ``angle`` the shaft's
            angle [rad]. Options: ``marks`` in one turn, ``gate_s`` and the clock's ``tick_s``.

    Returns:
        Series, one entry a gate: ``gate_time`` (its middle), ``counted_speed`` and the true
        ``mean_speed``; one entry a gate in whose middle two marks can be told apart:
        ``period_time`` and ``timed_speed``. Values: ``gate_resolution`` 2π/(n·T),
        ``gate_uncertainty`` (that over √6), ``counting_error`` (root mean square of counted - mean,
        to be compared with the uncertainty), and the largest errors of either way.
    """
    marks, tick_s = round(request.options["marks"]), request.options["tick_s"]
    edges = _gates(trajectory.time_s, request.options["gate_s"])
    time_s, angle = trajectory.time_s[edges], request.observed(trajectory, "angle")
    gate_s = float(time_s[1] - time_s[0]) if len(edges) > 1 else request.options["gate_s"]
    mean = np.diff(angle[edges]) / gate_s
    counted = encoder.counted_speeds(request.observed(trajectory)[edges], marks, gate_s)
    middle = (time_s[1:] + time_s[:-1]) / 2
    timed_at, timed, exact = _timed(angle, trajectory.time_s, middle, (marks, tick_s))
    error = counted - mean
    return Measured(
        values={
            "gate_resolution": encoder.gate_resolution(marks, gate_s),
            "gate_uncertainty": encoder.gate_uncertainty(marks, gate_s),
            "counting_error": math.sqrt(float(np.mean(error**2))) if len(error) else None,
            "largest_counting_error": _window.largest(error),
            "largest_timing_error": _window.largest(timed - exact),
        },
        series={
            "gate_time": middle,
            "counted_speed": counted,
            "mean_speed": mean,
            "period_time": timed_at,
            "timed_speed": timed,
        },
    )


def _gates(time_s: Array, gate_s: float) -> NDArray[np.intp]:
    """Indices of the samples at which one gate ends and the next begins."""
    step_s = float(time_s[-1] - time_s[0]) / max(len(time_s) - 1, 1)
    samples = max(1, round(gate_s / step_s)) if step_s else 1
    return np.arange(0, len(time_s), samples)


def _timed(
    angle: Array, time_s: Array, middle: Array, clock: tuple[int, float]
) -> tuple[Array, Array, Array]:
    """Where a period can be timed: its gate's middle, the speed on the clock, the exact one."""
    marks, tick_s = clock
    # where it turns back a mark may pass twice, and does not tell which way
    if np.any(np.diff(angle) < 0):
        return np.zeros(0), np.zeros(0), np.zeros(0)
    numbers = np.floor(np.interp(middle, time_s, angle) * marks / (2 * math.pi))
    inside = (numbers + 1) * 2 * math.pi / marks <= angle[-1]
    before = encoder.passing_times(angle, time_s, marks, numbers[inside])
    after = encoder.passing_times(angle, time_s, marks, numbers[inside] + 1)
    rows = [
        (t, speed, 2 * math.pi / marks / (second - first))
        for t, first, second in zip(middle[inside], before, after, strict=True)
        if (speed := encoder.timed_speed((first, second), marks, tick_s)) is not None
    ]
    middle_s, timed, exact = np.array(rows, dtype=float).reshape(-1, 3).T
    return middle_s, timed, exact
