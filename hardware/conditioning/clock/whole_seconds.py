"""Stamps that are rounded: when within a step of them a sample was taken is not known."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import MAX_ROWS

#: in seconds, the coarsest first
_STEPS = ((60.0, "minutes"), (1.0, "seconds"))


def keep(work: Work, step_s: float = 0.0) -> bool:
    """Keeps such stamps with their uncertainty, where the samples are not evenly spaced.

    Samples that share a stamp are spread over its step, in their order. Stamps that are even are
    left alone: the part of a second that they all lack changes no step.

    Args:
        work: the stream.
        step_s: to which its stamps are rounded [s]; 0 for whole seconds or minutes alone.
    """
    step_s, words = (step_s, f"multiples of {step_s:.6g} s") if step_s else _step(work)
    steps = np.diff(work.time_s)
    if not step_s or (steps < 0).any() or np.ptp(steps) == 0:
        return False
    shared = int((steps == 0).sum())
    u_s = step_s / np.sqrt(12)
    work.resolution_s = step_s
    work.u_time_s = float(np.hypot(work.u_time_s, u_s))
    text = f"the stamps are {words}, and the samples not evenly spaced: u = {u_s:.2g} s"
    after = {"resolution_s": step_s, "u_time_s": work.u_time_s}
    column = work.stream.time or ""
    if not shared:
        work.info("whole_seconds", f"{text}; the stamps are kept", channel=column, after=after)
        return True
    first = np.flatnonzero(np.concatenate(([True], steps > 0)))
    count = np.diff(np.append(first, len(work.time_s)))
    inside = intervals.spread(np.zeros_like(count), count)
    work.time_s += step_s * ((inside + 0.5) / np.repeat(count, count) - 0.5)
    work.repair(
        "whole_seconds", f"{text}; {shared} of {len(work.time_s)} samples share a stamp, and are"
        " spread evenly over it", samples=(np.flatnonzero(steps == 0) + 1)[:MAX_ROWS],
        count=shared, channel=column, after=after,
    )  # fmt: skip
    return True


def _step(work: Work) -> tuple[float, str]:
    """By what all stamps are whole, 0 where they are finer, or so far apart that none matters."""
    time = work.time_s
    if work.stream.time is None or len(time) < 3 or not np.isfinite(time).all():
        return 0.0, ""
    mean = float(np.ptp(time)) / (len(time) - 1)
    for step_s, word in _STEPS:
        near = time / step_s
        if np.ptp(time) < 0.5 * step_s:  # a trace of microseconds, all near to 0 minutes
            continue
        if step_s >= 0.05 * mean and np.abs(near - np.round(near)).max() < 1e-6:
            return step_s, f"whole {word}"
    return 0.0, ""
