"""The column that counts the samples, where a log has one: it tells what is missing."""

from __future__ import annotations

import re

import numpy as np

from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import RawColumn
from simcompare.model.trajectory import Array

#: columns whose name says that they count samples where they are made, not rows where they arrive
_NAME = re.compile(
    r"^(seq|sequence|counter|packet|frame|sample)s?[ _.]?(no|nr|num|number|id|count|counter)?$",
    re.IGNORECASE,
)
#: and those that count or number anything
_COUNTS = re.compile(
    r"(?:^|[ _.#])(?:seq|sequence|count|counter|packet|frame|sample|scan|index|idx|id|row|record"
    r"|line|no|nr|num|number|cycle|unnamed: \d+)s?\.?$|^(?:#|n|i|k|(?:packet|frame|sample)s?\b.*)$",
    re.IGNORECASE,
)
#: a counter goes on by no more than this from row to row
_MAX_STRIDE = 16
#: numbers after which counters begin again
WRAPS = (2.0**8, 2.0**16, 2.0**32)


def is_named(name: str) -> bool:
    """Whether a name says that a column numbers rows, and tells no time."""
    return bool(_COUNTS.search(name.strip()))


def column_of(work: Work) -> RawColumn | None:
    """The numbers of the samples, by ones, where a column counts them up by equal steps."""
    for column in work.data:
        if column.name != work.stream.counter and not _NAME.match(column.name):
            continue
        step = intervals.sampled_steps(column.values)
        if len(step) < 8 or not intervals.whole_numbers(column):
            continue
        if np.mean(step == 1) >= 0.8:
            return column
        stride = float(np.nanmedian(step))
        # a device that numbers all its packets, of which this log has each second or third
        if (
            1 < stride <= _MAX_STRIDE
            and not (step % stride).any()
            and np.mean(step == stride) >= 0.8
        ):
            return RawColumn(column.name, column.values / stride)
    return None


def increments(step: Array, wrap: float | None) -> Array:
    """By how much the counter went on at each step, also where it began again."""
    return step if wrap is None else np.where(step < 0, step + wrap, step)


def wrap_of(column: RawColumn) -> float | None:
    """Number after which the counter begins again, ``None`` where it never does."""
    back = intervals.where(column.values, lambda step: step < 0)
    if not len(back):
        return None
    highest = float(np.nanmax(column.values[back]))
    return next((wrap for wrap in WRAPS if highest < wrap and highest > 0.9 * wrap), None)
