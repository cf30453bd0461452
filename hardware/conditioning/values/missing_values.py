"""Numbers that mean "nothing was measured" become missing values; they never become 0."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.words import are
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import RawColumn

#: no sensor means these; a channel may hold them for as long as it likes
_MARKS = (
    -999.0, -9999.0, -99999.0, -999.9, -9999.9, -999.99, -9999.99, -999.25, 9999.0, 99999.0,
    9999.99, 99999.99, 1e20, 1e30, 1e35, -1e30, 9.969209968386869e36, 3.4028234663852886e38,
    -3.4028234663852886e38, 1.7976931348623157e308, -1.7976931348623157e308,
    2147483647.0, -2147483648.0, 4294967295.0,
)  # fmt: skip
#: largest numbers of a few bits: a sensor may also mean them, so they must come singly
_FULL = (255.0, 8191.0, -8192.0, 16383.0, 32767.0, -32768.0, 65535.0)
#: how far away from all other values, in ranges of these
_FAR = 2.0
#: a full number is no value only in stretches as short as this, and as rare as this
_MAX_RUN, _MAX_SHARE = 3, 0.05
#: all that is left must take at least so many values, or an upper level is mistaken for a mark
_LEVELS = 3


def check(work: Work) -> None:
    """Finds infinite numbers and sentinels, and leaves out rows that hold nothing."""
    for column in work.stream.columns:
        _quiet(column)
        _infinite(work, column)
    _drop_empty(work)
    for column in work.data:
        wish = work.wishes(column)
        if wish is not None and wish.sentinels:
            for mark in wish.sentinels:
                _clear(work, column, mark, "the mapping says that it means: nothing measured")
        elif column.name != work.stream.counter:
            _guess(work, column)


def _quiet(column: RawColumn) -> None:
    """Damaged files may hold signalling NaN, with which NumPy finds wrong extremes."""
    column.values[np.isnan(column.values)] = np.nan


def _drop_empty(work: Work) -> None:
    """Rows without a time and without values hold nothing: they are no samples."""
    time = work.stream.time
    if time is None:
        return
    empty = np.isnan(work.stream.column(time).values)
    if not empty.any() or empty.all():
        return
    for column in work.data:
        empty &= np.isnan(column.values)
    rows = np.flatnonzero(empty)
    if len(rows):
        work.info("empty_row", "rows without time and values were left out", samples=rows)
        work.keep(~empty)


def _infinite(work: Work, column: RawColumn) -> None:
    samples = np.flatnonzero(np.isinf(column.values))
    if len(samples):
        column.values[samples] = np.nan
        work.repair(
            "infinite", f"{are(len(samples), 'sample')} infinite; nothing was measured there,"
            " so it is missing now", samples=samples, channel=column.name,
            after={"missing": float(len(samples))},
        )  # fmt: skip


def _guess(work: Work, column: RawColumn) -> None:
    """Removes marks that stand far outside all other values of the channel."""
    marks = _marks_in(column)
    if not marks:
        return
    low, high, levels = _rest(column, marks)
    if not levels:
        # a constant 255 may be a setting; a constant -999 is none
        for mark in [mark for mark in marks if mark in _MARKS and not 0 < mark < 1e20]:
            work.warn(
                "constant_sentinel",
                f"holds nothing but {mark:g}, which often means that nothing was measured; leave"
                " the column out, or name the value under sentinels in a mapping file",
                channel=column.name,
                samples=np.flatnonzero(column.values == mark),
            )
        return
    for mark in marks:
        away = max(low - mark, mark - high)
        if away <= _FAR * (high - low) or away <= 0:
            continue
        if levels < _LEVELS and (mark in _FULL or mark > 0):
            continue
        if mark in _FULL and not _single(column, mark):
            continue
        _clear(
            work, column, mark,
            f"all other values lie between {low:.6g} and {high:.6g}, so it means: nothing measured",
        )  # fmt: skip


def _marks_in(column: RawColumn) -> list[float]:
    # marks are rarely present: the extremes tell quickly that there are none
    low, high = intervals.extent(column.values)
    inside = [mark for mark in sorted((*_MARKS, *_FULL)) if low <= mark <= high]
    return [mark for mark in inside if (column.values == mark).any()]


def _rest(column: RawColumn, marks: list[float]) -> tuple[float, float, int]:
    """Smallest and largest value but for the marks, and how many levels there are (up to 3)."""
    rest = column.values[~np.isnan(column.values) & ~np.isin(column.values, marks)]
    low, high = intervals.extent(rest)
    return low, high, min(len(np.unique(rest)), _LEVELS)


def _single(column: RawColumn, mark: float) -> bool:
    """Whether a value comes in short and rare stretches only."""
    _, length = intervals.runs(column.values == mark)
    is_rare = length.sum() <= max(_MAX_SHARE * len(column.values), 1)
    return bool(is_rare) and int(length.max()) <= _MAX_RUN


def _clear(work: Work, column: RawColumn, mark: float, why: str) -> None:
    samples = np.flatnonzero(column.values == mark)
    if not len(samples):
        return
    column.values[samples] = np.nan
    work.repair(
        "sentinel",
        f"{are(len(samples), 'sample')} {mark:g}; {why}. It is missing now",
        samples=samples,
        channel=column.name,
        before={"value": mark},
        after={"missing": float(len(samples))},
    )
