"""Stamps that are missing, repeated, out of order, or made by a clock that was changed."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import bursts, clock_jumps, clock_wrap, intervals
from simcompare.hardware.conditioning.clock.intervals import Indices
from simcompare.hardware.conditioning.words import are
from simcompare.hardware.conditioning.work import Work

#: neighbours of a regular stamp are as far apart as this, in medians
_REGULAR = (0.6, 1.5)
#: a row that came late is looked for among so many before it
_LATE = 32
#: so many rows with one step back, after fewer than these of them, are one run
_RUN, _FEW = 10, 5
#: a clock that is set for the first time goes ahead by years [s], and shows hardly any before
_YEAR = 3.15e7
#: so many rows are put in order; a log with more is in none
_MAX_MOVED = 10_000


def check(work: Work) -> None:
    """Leaves stamps that increase, or faults that name the rows."""
    if len(work.time_s) < 2:
        if not work.faults:
            work.fault("holds one sample; expected at least two")
        return
    _missing(work)
    if work.faults:
        return
    median = intervals.typical(work.time_s)
    if median <= 0:
        work.fault(
            "the time never goes on; expected stamps that increase. If the samples are evenly"
            " spaced, write into a mapping file (--map), with as many samples a second as there"
            " were: time: {rate_Hz: 100}",
            channel=work.stream.time or "",
        )
        return
    clock_wrap.check(work)
    _before_set(work)
    _outliers(work, median)
    _late_rows(work, median)
    _stale_first(work)
    bursts.check(work)
    if not work.faults:
        clock_jumps.check(work)
    if not work.faults:
        _from_zero(work)
        _in_order(work)


def _missing(work: Work) -> None:
    """Stamps that are missing between regular neighbours are put between them."""
    holes = np.isnan(work.time_s)
    if not holes.any():
        return
    median = intervals.typical(work.time_s)
    first, length = intervals.runs(holes)
    filled: list[int] = []
    for start, count in zip(first.tolist(), length.tolist(), strict=True):
        before, after = start - 1, start + count
        if before < 0 or after >= len(holes):
            continue
        span = float(work.time_s[after] - work.time_s[before])
        if not _REGULAR[0] * median <= span / (count + 1) <= _REGULAR[1] * median or span <= 0:
            continue
        part = np.arange(1, count + 1) / (count + 1)
        work.time_s[start:after] = work.time_s[before] + span * part
        filled += range(start, after)
    if filled:
        work.repair(
            "time_missing", f"{are(len(filled), 'stamp')} missing; put evenly between the"
            " neighbours, where the clock is regular", samples=filled,
            channel=work.stream.time or "",
        )  # fmt: skip
    lost = np.flatnonzero(np.isnan(work.time_s))
    if len(lost):
        work.fault(
            f"{are(len(lost), 'sample')} without a time ({intervals.shorten(lost, work)}), and it"
            " cannot be told from the neighbours; correct or remove these rows",
            channel=work.stream.time or "",
        )


def _outliers(work: Work, median: float) -> None:
    """One stamp that is wrong between two that are right is put between them."""
    time = work.time_s
    back = intervals.where(time, lambda step: step < 0)
    outliers: list[int] = []
    for i in back[:_MAX_MOVED].tolist():
        for wrong in (i, i + 1):
            if not 0 < wrong < len(time) - 1 or (outliers and outliers[-1] >= wrong - 1):
                continue
            before, after = float(time[wrong - 1]), float(time[wrong + 1])
            lies_outside = not before < time[wrong] < after
            if lies_outside and 2 * _REGULAR[0] <= (after - before) / median <= 2.5:
                time[wrong] = (before + after) / 2
                outliers.append(wrong)
                break
    if outliers:
        work.repair(
            "time_outlier", f"{are(len(outliers), 'stamp')} not between the neighbours, which are"
            " regular; put in the middle", samples=outliers, channel=work.stream.time or "",
        )  # fmt: skip


def _late_rows(work: Work, median: float) -> None:
    """Rows that came late go to their place, where the stamps are regular then."""
    time = work.time_s
    back = intervals.where(time, lambda step: step < 0)
    if not len(back) or len(back) > _MAX_MOVED:
        return  # the search for jumps of the clock says the rest
    moved: list[int] = []
    for i in back.tolist():
        if time[i + 1] >= time[i]:
            continue  # put right together with the one before
        window = _window(work, i)
        order = window.start + np.argsort(time[window], kind="stable")
        around = slice(max(window.start - 1, 0), min(window.stop + 1, len(time)))
        sorted_ = np.array(time[around])
        sorted_[window.start - around.start : window.stop - around.start] = time[order]
        steps = np.diff(sorted_) / median
        if steps.min() < _REGULAR[0] or steps.max() > _REGULAR[1]:
            continue
        # rows that stood further back; ``samples`` are counted in the new order
        late = order > np.arange(window.start, window.stop)
        moved += (window.start + np.flatnonzero(late)).tolist()
        _reorder(work, window, order)
    if moved:
        work.repair(
            "time_order", f"{are(len(moved), 'row')} later in the log than the stamp says; put in"
            " place, after which the stamps are regular", samples=moved,
        )  # fmt: skip


def _stale_first(work: Work) -> None:
    """The first rows, left over from the run before, go; the rest is one log."""
    back = intervals.where(work.time_s, lambda step: step < 0)
    if len(work.time_s) < _RUN or len(back) != 1 or back[0] >= _FEW - 1:
        return
    last = int(back[0])
    stale, first = (work.start_s + float(work.time_s[i]) for i in (last, last + 1))
    what = f"{work.place(0)} alone is" if not last else f"the first {last + 1} rows are"
    work.repair(
        "stale_first_row", f"{what} out of order: {stale:.6g} s, before {first:.6g} s;"
        " left over from the run before, and left out", samples=np.arange(last + 1),
        channel=work.stream.time or "", before={"first_s": stale}, after={"first_s": first},
    )  # fmt: skip
    work.keep(np.arange(len(work.time_s)) > last)


def _before_set(work: Work) -> None:
    """Rows that were written before the clock was set go, where they are the fewer."""
    ahead = intervals.where(work.time_s, lambda step: step > _YEAR)
    if len(ahead) != 1 or work.start_s > _YEAR or ahead[0] > len(work.time_s) // 2:
        return
    count = int(ahead[0]) + 1
    work.repair(
        "clock_set", f"the first {count} rows were written before the clock was set (it goes ahead"
        f" by {float(np.diff(work.time_s)[ahead[0]]) / _YEAR:.3g} years after them); left out",
        samples=np.arange(count), channel=work.stream.time or "",
    )  # fmt: skip
    work.keep(np.arange(len(work.time_s)) >= count)


def _window(work: Work, i: int) -> slice:
    """The rows around a step back that overlap in time."""
    time = work.time_s
    start = max(i - _LATE, 0)
    later = start + np.flatnonzero(time[start : i + 1] > time[i + 1])
    first = int(later[0])
    latest = float(time[first : i + 1].max())
    stop = min(i + 2 + _LATE, len(time))
    earlier = i + 1 + np.flatnonzero(time[i + 1 : stop] < latest)
    return slice(first, int(earlier[-1]) + 1)


def _reorder(work: Work, window: slice, order: Indices) -> None:
    for column in work.stream.columns:
        if column.values is not work.time_s:
            column.values[window] = column.values[order]
        if isinstance(column.u, np.ndarray):
            column.u[window] = column.u[order]
    work.time_s[window] = work.time_s[order]
    rows = work.stream.rows
    if rows is None:
        rows = np.arange(len(work.stream), dtype=np.int64) + work.stream.first_row
        work.stream.rows = rows
    rows[window] = rows[order]


def _from_zero(work: Work) -> None:
    """Times begin with 0 at the first sample, also after rows were left out."""
    first = float(work.time_s[0])
    if first != 0.0:
        work.start_s += first
        work.time_s -= first


def _in_order(work: Work) -> None:
    """Whatever was repaired: what is handed on increases, or is refused."""
    wrong = intervals.where(work.time_s, lambda step: ~((step > 0) & (step < np.inf)))
    if len(wrong):
        work.fault(
            f"the times do not increase ({intervals.shorten(wrong + 1, work)}) and cannot be put"
            " right; correct these stamps (time_order)",
            sample=int(wrong[0]) + 1,
            channel=work.stream.time or "",
        )
