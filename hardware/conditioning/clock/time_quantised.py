"""Stamps of a clock that counts in coarse steps, such as 1 ms or 15.6 ms."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals, whole_seconds
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import MAX_ROWS
from simcompare.model.trajectory import Array

#: steps of the clock that are coarse against the time between samples
_COARSE = 0.05
#: and those that do not matter
_FINE = 1e-5
#: stamps of an even clock lie within so many steps of a line, and scatter by less
_PEAK, _SCATTER = 1.5, 0.6
#: fewer stamps that are shared or skipped are accidents, no way of the clock
_SEVERAL = 5


def check(work: Work) -> None:
    """Gives the stamps their uncertainty; evens them out where they are even but for rounding."""
    if work.resolution_s > 0 or work.stream.time is None:
        return  # done already, or no stamps at all
    step = intervals.quantum(work)
    median = intervals.typical(work.time_s)
    rounding = intervals.float_step(work)
    if step == 0 and rounding > _FINE * median:
        # floating-point numbers since 1970 hold no more than a quarter of a microsecond
        work.resolution_s = rounding
        work.u_time_s = float(np.hypot(work.u_time_s, rounding / np.sqrt(12)))
        return
    if step == 0 or (step > 0.7 * median and not _ragged(work, step)):
        whole_seconds.keep(work)
        return
    if step > _COARSE * median and even_out(work, step):
        return
    if whole_seconds.keep(work):
        return
    work.resolution_s = step
    work.u_time_s = float(np.hypot(work.u_time_s, step / np.sqrt(12)))
    if step > _COARSE * median:
        work.info(
            "time_quantised", f"the stamps are whole multiples of {step:.6g} s; they are left, as"
            " the samples were not evenly spaced",
            after={"resolution_s": step, "u_time_s": work.u_time_s},
        )  # fmt: skip


def even_out(work: Work, step: float | None = None) -> bool:
    """Puts the stamps on an even grid, if they are that but for the steps of the clock.

    Args:
        work: the stream.
        step: of the clock [s], where it is known.
    """
    if work.stream.time is None:
        return False
    step = step if step is not None else intervals.quantum(work)
    if step == 0 or (step > 0.7 * intervals.typical(work.time_s) and not _ragged(work, step)):
        return False
    fit = _line(work.time_s, step)
    if fit is None:
        return False
    _write(work, step, fit)
    return True


def _ragged(work: Work, step: float) -> bool:
    """Whether samples come about as fast as the clock counts: some share a stamp, or skip one.

    Lost samples skip stamps as well, and rows sent twice share one; but these are rare, and what
    is skipped is not made up for.
    """
    steps = intervals.sampled_steps(work.time_s)
    shared, skipped = int((steps == 0).sum()), int((steps > 1.5 * step).sum())
    many = max(0.02 * len(steps), _SEVERAL - 1)
    return max(shared, skipped) > many or (shared >= _SEVERAL and skipped > 0.5 * shared)


def _line(time_s: Array, step: float) -> tuple[float, float, float] | None:
    """Time of sample 0, time between samples and scatter of an even clock, ``None`` if not even."""
    count = len(time_s)
    index = _indices(time_s, step)
    n, i, total, ii, it = (
        count, index.sum(), time_s.sum(), (index * index).sum(), (index * time_s).sum(),
    )  # fmt: skip
    slope = float((n * it - i * total) / (n * ii - i * i)) if count > 1 else 0.0
    start = float((total - slope * i) / n)
    if not slope > 0:
        return None
    off = time_s - (start + slope * index)
    peak, scatter = float(np.abs(off).max()), float(np.sqrt(off @ off / count))
    # the number of a sample is certain only if its stamp is nearer than half the step to the line
    return (start, slope, scatter) if peak <= _PEAK * step and scatter <= _SCATTER * step else None


def _indices(time_s: Array, step: float) -> Array:
    """Numbers of the samples on the even grid; pauses count as lost samples."""
    steps = np.diff(time_s)
    # longer steps of the stamps are pauses
    is_pause = steps > 1.5 * intervals.typical(time_s) + 1.5 * step
    period = steps[~is_pause].mean()
    return np.concatenate(([0.0], np.cumsum(np.where(is_pause, np.round(steps / period), 1.0))))


def _write(work: Work, step: float, fit: tuple[float, float, float]) -> None:
    start, slope, scatter = fit
    time = work.time_s
    rounding = step / np.sqrt(12)
    # what the scatter exceeds rounding by is jitter; less than chance makes cannot be seen
    jitter = np.sqrt(max(scatter**2 - rounding**2, 0.0))
    u = max(float(jitter), rounding * len(time) ** -0.25)
    grid = start + slope * _indices(time, step)
    changed = int((np.abs(grid - time) > 1e-6 * step).sum())
    time[:] = grid
    work.resolution_s = step
    work.u_time_s = float(np.hypot(work.u_time_s, u))
    work.repair(
        "time_quantised",
        f"the stamps are whole multiples of {step:.6g} s, and even but for that; put on the even"
        f" grid of {slope:.9g} s that fits them best ({changed} of {len(time)} changed)",
        samples=np.arange(min(len(time), MAX_ROWS)),
        count=len(time),
        channel=work.stream.time or "",
        before={"resolution_s": step, "u_time_s": float(rounding)},
        after={"dt_s": float(slope), "u_time_s": work.u_time_s, "scatter_s": scatter},
    )
