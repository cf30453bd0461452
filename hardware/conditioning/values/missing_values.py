"""Numbers that mean "nothing was measured" become missing values; they never become 0."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import RawColumn, blocks

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
_LONGEST, _SHARE = 3, 0.05
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
    for part in blocks(len(column.values)):
        block = column.values[part]
        missing = np.isnan(block)
        if missing.any():
            block[missing] = np.nan


def _drop_empty(work: Work) -> None:
    """Rows without a time and without values hold nothing: they are no samples."""
    time = work.stream.time
    if time is None:
        return
    empty = np.isnan(work.stream.column(time).values)
    if not empty.any() or empty.all():
        return
    for column in work.data:
        for part in blocks(len(empty)):
            empty[part] &= np.isnan(column.values[part])
    rows = np.flatnonzero(empty)
    if len(rows):
        work.info("empty_row", "rows without time and values were left out", samples=rows)
        work.keep(~empty)


def _infinite(work: Work, column: RawColumn) -> None:
    found = [
        part.start + np.flatnonzero(np.isinf(column.values[part]))
        for part in blocks(len(column.values))
    ]
    samples = np.concatenate(found) if found else np.empty(0, dtype=np.int64)
    if len(samples):
        column.values[samples] = np.nan
        work.repair(
            "infinite",
            f"{_times(len(samples))} infinite; nothing was measured there, so it is missing now",
            samples=samples,
            channel=column.name,
            after={"missing": float(len(samples))},
        )


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
    # marks are rarely present: the extremes of a block tell quickly that there are none
    present: set[float] = set()
    candidates = np.array(sorted((*_MARKS, *_FULL)))
    for part in blocks(len(column.values)):
        block = column.values[part]
        if np.isnan(block).all():
            continue
        low, high = np.nanmin(block), np.nanmax(block)
        inside = candidates[(candidates >= low) & (candidates <= high)]
        present.update(float(mark) for mark in inside if (block == mark).any())
    return sorted(present)


def _rest(column: RawColumn, marks: list[float]) -> tuple[float, float, int]:
    """Smallest and largest value but for the marks, and how many levels there are (up to 3)."""
    low, high, levels = np.inf, -np.inf, set[float]()
    for part in blocks(len(column.values)):
        block = column.values[part]
        block = block[~np.isnan(block) & ~np.isin(block, marks)]
        if not len(block):
            continue
        low, high = min(low, float(block.min())), max(high, float(block.max()))
        if len(levels) < _LEVELS:
            levels.update(np.unique(block)[:_LEVELS].tolist())
    return low, high, len(levels)


def _single(column: RawColumn, mark: float) -> bool:
    """Whether a value comes in short and rare stretches only."""
    count = sum(int((column.values[part] == mark).sum()) for part in blocks(len(column.values)))
    if count > max(_SHARE * len(column.values), 1):
        return False
    _, length = intervals.runs(np.asarray(column.values == mark))
    return int(length.max()) <= _LONGEST


def _clear(work: Work, column: RawColumn, mark: float, why: str) -> None:
    found = [
        part.start + np.flatnonzero(column.values[part] == mark)
        for part in blocks(len(column.values))
    ]
    samples = np.concatenate(found) if found else np.empty(0, dtype=np.int64)
    if not len(samples):
        return
    column.values[samples] = np.nan
    work.repair(
        "sentinel",
        f"{_times(len(samples))} {mark:g}; {why}. It is missing now",
        samples=samples,
        channel=column.name,
        before={"value": mark},
        after={"missing": float(len(samples))},
    )


def _times(count: int) -> str:
    return "one sample is" if count == 1 else f"{count} samples are"
