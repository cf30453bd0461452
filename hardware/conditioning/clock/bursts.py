"""Samples that share a stamp: rows sent twice, bursts of a buffer, several rows for one moment."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals, time_quantised, whole_seconds
from simcompare.hardware.conditioning.clock.intervals import Indices, Mask
from simcompare.hardware.conditioning.words import are
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import MAX_ROWS, RawColumn
from simcompare.model.trajectory import Array

#: from this share of repeated stamps on, sharing a stamp is the way of the log, not an accident
_PATTERN = 0.2
#: stamps are coarse that are rounded to more than this of the time between samples
_COARSE = 0.05
#: bursts are of one clock when their steps differ by less than this factor, most of them
_STEADY, _MIN_STEADY_SHARE = 2.0, 0.8
#: rows of one moment that are looked at as one
_MAX_WIDTH = 16


def check(work: Work) -> None:
    """Leaves stamps that are not repeated, or a fault."""
    again = intervals.where(work.time_s, lambda step: step == 0)
    if not len(again):
        return
    alike = _alike(work, again)
    if _sent_twice(work, again, alike):
        _drop(work, again[alike])
        again = again[~alike]
    if len(again) and alike.all() and len(again) < _PATTERN * len(work.time_s):
        _drop(work, again)
        return
    again = intervals.where(work.time_s, lambda step: step == 0)
    if not len(again) or _join(work, again) or _several_things(work):
        return
    if time_quantised.even_out(work) or whole_seconds.keep(work):
        return
    if len(again) < _PATTERN * len(work.time_s):
        _accidents(work)
    else:
        _spread(work)


def _alike(work: Work, pairs: Indices) -> Mask:
    """Whether rows i and i+1 are equal in all columns, for each i."""
    alike = np.ones(len(pairs), dtype=np.bool_)
    for column in work.data:
        alike &= intervals.same(column.values[pairs], column.values[pairs + 1])
    return alike


def _sent_twice(work: Work, again: Indices, alike: Mask) -> bool:
    """Whether rows with the same stamp are copies, while neighbours else are not alike."""
    if not alike.any():
        return False
    onwards = intervals.where(work.time_s, lambda step: step != 0)
    if not len(onwards):
        return False
    some = onwards[:: max(len(onwards) // 10_000, 1)]
    return bool(_alike(work, some).mean() <= 0.5 * alike.mean()) and bool(
        alike.mean() > 0.9 or len(again) < _PATTERN * len(work.time_s)
    )


def _drop(work: Work, before: Indices) -> None:
    """Leaves out the rows after those given, which are equal to them."""
    copies = before + 1
    work.repair(
        "duplicate_row",
        f"{are(len(copies), 'row')} the same as the row before, with the same stamp; left out",
        samples=copies,
        before={"samples": float(len(work.time_s))},
        after={"samples": float(len(work.time_s) - len(copies))},
    )
    kept = np.ones(len(work.time_s), dtype=np.bool_)
    kept[copies] = False
    work.keep(kept)


def _groups(time_s: Array) -> tuple[Indices, Indices]:
    """First index and number of the samples that share a stamp."""
    onwards = intervals.where(time_s, lambda step: step != 0)
    first = np.concatenate(([0], onwards + 1))
    return first, np.diff(np.concatenate((first, [len(time_s)])))


def _join(work: Work, again: Indices) -> bool:
    """Joins rows of one moment that each hold other columns; nothing is lost by it."""
    holes = any(np.isnan(column.values[again[:1000]]).any() for column in work.data)
    first, count = _groups(work.time_s)
    if not holes or count.max() > _MAX_WIDTH:
        return False
    if any(not _complete_each_other(column, first, count) for column in work.data):
        return False
    kept = np.zeros(len(work.time_s), dtype=np.bool_)
    kept[first] = True
    joined = np.flatnonzero(~kept)
    for column in work.data:
        for further in range(1, int(count.max())):
            here = first[count > further]
            empty = np.isnan(column.values[here])
            column.values[here[empty]] = column.values[here[empty] + further]
    work.info(
        "joined_rows", f"{len(joined)} rows hold other columns of the moment of the row before;"
        " joined with it", samples=joined,
    )  # fmt: skip
    work.keep(kept)
    return True


def _complete_each_other(column: RawColumn, first: Indices, count: Indices) -> bool:
    """Whether no two rows of a moment hold different values of the column."""
    for further in range(1, int(count.max())):
        here = first[count > further]
        for nearer in range(further):
            a, b = column.values[here + nearer], column.values[here + further]
            if ((a != b) & ~np.isnan(a) & ~np.isnan(b)).any():
                return False
    return True


def _accidents(work: Work) -> None:
    """Repeated stamps here and there: copies go; so do other rows, but where rounding says why."""
    again = intervals.where(work.time_s, lambda step: step == 0)
    alike = _alike(work, again)
    if alike.all():
        _drop(work, again)
        return
    step = intervals.quantum(work)
    if step > _COARSE * intervals.typical(work.time_s) and whole_seconds.keep(work, step):
        return
    work.repair(
        "duplicate_time",
        f"{are(len(again), 'row')} left out: {'it has' if len(again) == 1 else 'they have'} the"
        f" stamp of the row before but other values ({intervals.shorten(again + 1, work)}), and"
        " when they were measured is not known",
        samples=again + 1,
        channel=work.stream.time or "",
    )
    kept = np.ones(len(work.time_s), dtype=np.bool_)
    kept[again + 1] = False
    work.keep(kept)


def _several_things(work: Work) -> bool:
    """A fault where the rows of a stamp are of several things, told apart by a column."""
    first, count = _groups(work.time_s)
    usual = int(np.median(count))
    if usual < 2 or np.mean(count == usual) < 0.9:
        return False
    some = first[count == usual][:2000]
    if len(some) < 3:
        return False
    for column in work.data:
        table = column.values[some[:, None] + np.arange(usual)]
        if (table == table[0]).all() and len(np.unique(table[0])) > 1:
            work.fault(
                f"tells {len(np.unique(table[0]))} things apart that share each stamp; write each"
                " thing into columns (or a file) of its own (duplicate_time)",
                sample=int(some[0]) + 1,
                channel=column.name,
            )
            return True
    return False


def _spread(work: Work) -> None:
    """Spreads bursts over the time since the one before: a stamp is that of the last sample."""
    time = work.time_s
    first, count = _groups(time)
    stamp = np.array(time[first])
    step = np.diff(stamp) / count[1:]
    if len(step) < 2 or (step <= 0).any():
        _no_pattern(work, first, count)
        return
    usual = _weighted_median(step, count[1:])
    steady = np.abs(np.log(step / usual)) < np.log(_STEADY)
    if count[1:][steady].sum() < _MIN_STEADY_SHARE * count[1:].sum():
        _no_pattern(work, first, count)
        return
    # after a pause, a burst is as long as any other
    each = np.concatenate(([usual], np.where(step > 1.5 * usual, usual, step)))
    jitter = float(np.std((np.diff(stamp) - count[1:] * usual)[steady]) / np.sqrt(2))
    shared = int((count - 1).sum())
    inside = intervals.spread(np.zeros_like(count), count)
    before_stamp = np.repeat(count - 1, count) - inside
    time[:] = np.repeat(stamp, count) - before_stamp * np.repeat(each, count)
    work.u_time_s = float(np.hypot(work.u_time_s, jitter))
    work.resolution_s = float(np.median(step * count[1:]))
    work.repair(
        "burst_time", f"{shared} of {len(time)} samples have the stamp of the sample before: they"
        f" came in bursts of {_sizes(count)}. A stamp is taken as that of the last sample of its"
        " burst, and the others are spread evenly over the time since the burst before",
        samples=_sharing(first, count),
        count=shared,
        channel=work.stream.time or "",
        before={"median_dt_s": 0.0, "resolution_s": work.resolution_s},
        after={"median_dt_s": usual, "u_time_s": work.u_time_s},
    )  # fmt: skip


def _sharing(first: Indices, count: Indices) -> Indices:
    """The samples whose stamp is that of a later one, as many as are named."""
    enough = int(np.searchsorted(np.cumsum(count - 1), MAX_ROWS)) + 1
    return intervals.spread(first[:enough], count[:enough] - 1)


def _no_pattern(work: Work, first: Indices, count: Indices) -> None:
    step = intervals.quantum(work)
    if step and whole_seconds.keep(work, step):
        return
    sharing = first[count > 1] + 1
    work.fault(
        f"{int((count - 1).sum())} samples share a stamp with the one before"
        f" ({intervals.shorten(sharing, work)}) and follow no pattern that tells when they were"
        " taken; if they are evenly spaced, write into a mapping file (--map):"
        f" time: {{rate_Hz: {_mean_rate(work):.6g}}} (duplicate_time)",
        sample=int(sharing[0]),
        channel=work.stream.time or "",
    )


def _mean_rate(work: Work) -> float:
    """Samples in a second, over the whole log."""
    return (len(work.time_s) - 1) / float(np.ptp(work.time_s))


def _weighted_median(values: Array, weights: Indices) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, total[-1] / 2)])


def _sizes(count: Indices) -> str:
    low, high = int(np.quantile(count, 0.05)), int(np.quantile(count, 0.95))
    return str(low) if low == high else f"{low} to {high}"
