"""Counters of few bits that begin again: an encoder of 16 bits jumps from 65535 to 0.

A signed number of 16 bits that was logged as an unsigned one makes the same jumps (65535 is -1),
but never comes near the middle of the range.
"""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.clock.intervals import Indices
from simcompare.hardware.conditioning.words import times
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import RawColumn
from simcompare.model.trajectory import Array

#: lowest and highest number of counters that are recognised without a mapping
_RANGES = (
    (0.0, 2.0**8), (-(2.0**7), 2.0**7), (0.0, 2.0**16), (-(2.0**15), 2.0**15),
    (0.0, 2.0**32), (-(2.0**31), 2.0**31),
)  # fmt: skip
#: steps of a counter that certainly wraps, in parts of its range
_SMALL = 1 / 16
#: beyond this part of the range it cannot be told any more which way a step went
_AMBIGUOUS = 0.4
#: values that a signed number logged as unsigned takes on one side of 0, at least; 2 on the other
_LEVELS = 3
#: steps before and after a wrap that must go the same way
_NEAR = 3


def check(work: Work) -> None:
    """Adds up the turns of counters that begin again."""
    for column in work.data:
        wish = work.wishes(column)
        if wish is not None and wish.wraps is not None:
            _stated_wrap(work, column, wish.wraps)
        elif column.name != work.stream.counter and intervals.whole_numbers(column):
            _guessed_wrap(work, column)


def _stated_wrap(work: Work, column: RawColumn, wrap: float) -> None:
    """The mapping says where the counter begins again."""
    after, step = steps(column)
    turned = step - wrap * np.round(step / wrap)
    fast = after[np.abs(turned) > _AMBIGUOUS * wrap]
    if len(fast):
        work.fault(
            f"moves by more than {_AMBIGUOUS:g} of the {_amount(column, wrap)} after which it"
            f" begins again ({intervals.shorten(fast, work)}), so it cannot be told how often it"
            " did; record with shorter intervals, or correct wraps in the mapping file"
            " (counter_wrap)",
            sample=int(fast[0]),
            channel=column.name,
        )
        return
    at = after[np.round(step / wrap) != 0]
    if len(at):
        unwrap(work, column, wrap, at)


def _guessed_wrap(work: Work, column: RawColumn) -> None:
    """Jumps that only a counter of 8, 16 or 32 bits makes, while it moves slowly else."""
    low, high = intervals.extent(column.values)
    for start, stop in _RANGES:
        wrap = stop - start
        # both ends are in use, and nothing beyond: else it is no counter of so many bits
        near = _SMALL * wrap
        if low < start or high >= stop or low > start + near or high < stop - 1 - near:
            continue
        at, medium = jumps(work, column, wrap, _SMALL)
        if not len(at):
            continue
        if start == 0 and wrap > 2**8 and _is_signed(column, wrap):
            _make_signed(work, column, wrap)
            return
        turning = np.array([_turns(column, int(i), wrap) for i in at[:1000]])
        # near a place where it turns back, a counter goes either way: most of them must agree
        if turning.mean() >= 0.5 and not medium:
            unwrap(work, column, wrap, at)
        elif turning.any() and medium <= len(at):
            work.warn(
                "counter_wrap", f"jumps by almost {wrap:g}, as a counter that begins again does,"
                " but also moves in other ways; left as it is. If it is such a counter, say so in"
                f' a mapping file (--map): "wraps: {wrap:g}"', samples=at, channel=column.name,
            )  # fmt: skip
        return


def steps(column: RawColumn) -> tuple[Indices, Array]:
    """Steps between values that are there: index of the second, and the difference."""
    there = np.flatnonzero(np.isfinite(column.values))
    return there[1:], np.diff(column.values[there])


def jumps(work: Work, column: RawColumn, wrap: float, small: float) -> tuple[Indices, int]:
    """Where the column jumps by almost its range, and how many steps lie in between.

    Args:
        work: the stream.
        column: one of its columns.
        wrap: after how much it begins again.
        small: part of that which is an ordinary step.
    """
    after, step = steps(column)
    size = np.abs(step) / wrap
    between = after[(size > small) & (size < 1 - small)]
    return after[size >= 1 - small], len(np.setdiff1d(between, np.array(work.gaps, int) + 1))


def _is_signed(column: RawColumn, wrap: float) -> bool:
    """Whether the middle half of the range is never used, and both ends are by several."""
    values = column.values
    if ((values > wrap / 4) & (values < 3 * wrap / 4)).any():
        return False
    sides = values < wrap / 2, values > wrap / 2
    few, more = sorted(len(np.unique(values[side])) for side in sides)
    return few >= 2 and more >= _LEVELS


def _make_signed(work: Work, column: RawColumn, wrap: float) -> None:
    low, high = intervals.extent(column.values)
    samples = np.flatnonzero(column.values > wrap / 2)
    column.values[samples] -= wrap
    now_low, now_high = intervals.extent(column.values)
    work.repair(
        "signed_number", f"{len(samples)} values lie just below {wrap:g} and all others just above"
        f" 0: a signed number was logged as an unsigned one. {wrap:g} was taken off them",
        samples=samples, channel=column.name, before={"min": low, "max": high},
        after={"min": now_low, "max": now_high},
    )  # fmt: skip


def _turns(column: RawColumn, after: int, wrap: float) -> bool:
    """Whether the column moves towards the end of its range and away from the other one."""
    values = column.values
    before = np.asarray(values[max(after - 1 - _NEAR, 0) : after])
    behind = np.asarray(values[after : after + 1 + _NEAR])
    before, behind = before[np.isfinite(before)], behind[np.isfinite(behind)]
    if not len(before) or not len(behind):
        return False
    way = -np.sign(behind[0] - before[-1])
    gone = np.array([before[-1] - before[0], behind[-1] - behind[0]])
    # a step that wraps in this neighbourhood as well would look like a jump
    gone = gone - wrap * np.round(gone / wrap)
    turned = behind[0] - before[-1] + way * wrap
    return bool((way * gone > 0).any() and (way * gone >= 0).all() and way * turned >= 0)


def unwrap(
    work: Work, column: RawColumn, wrap: float, at: Indices, rule: str = "counter_wrap"
) -> None:
    """Adds up the turns of a column that begins again after ``wrap``, and records it.

    Args:
        work: the stream.
        column: one of its columns.
        wrap: after how much it begins again, in its own unit.
        at: samples before which it does.
        rule: under which it is recorded.
    """
    low, high = intervals.extent(column.values)
    there = np.flatnonzero(np.isfinite(column.values))
    turns = np.cumsum(np.round(np.diff(column.values[there]) / wrap))
    column.values[there[1:]] -= wrap * turns
    now_low, now_high = intervals.extent(column.values)
    work.repair(
        rule, f"begins again after {_amount(column, wrap)}, {times(len(at))}; the turns were"
        " added up", samples=at, channel=column.name, before={"min": low, "max": high},
        after={"min": now_low, "max": now_high},
    )  # fmt: skip
    _unsure(work, column, wrap)


def _unsure(work: Work, column: RawColumn, wrap: float) -> None:
    """In a long gap the counter may have begun again more often than can be told."""
    if not work.gaps:
        return
    speed = float(np.nanquantile(np.abs(intervals.sampled_steps(column.values)), 0.99))
    gaps = np.array(work.gaps, dtype=np.int64)
    lasts = (work.time_s[gaps + 1] - work.time_s[gaps]) / intervals.typical(work.time_s)
    unsure = gaps[lasts * speed > wrap / 2]
    if len(unsure):
        work.warn(
            "counter_wrap_in_gap", "is fast enough to begin again within a gap; from there on it"
            f" may be off by whole multiples of {_amount(column, wrap)}", samples=unsure + 1,
            channel=column.name,
        )  # fmt: skip


def _amount(column: RawColumn, wrap: float) -> str:
    """A range in the unit of the column: ``360 deg``, ``4096 counts``."""
    return f"{wrap:.6g} {'counts' if column.unit in ('', '1') else column.unit}"
