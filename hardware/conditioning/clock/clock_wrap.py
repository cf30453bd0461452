"""Clocks that begin again: counters of 16 or 32 bits, seconds since midnight."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.words import times
from simcompare.hardware.conditioning.work import Work
from simcompare.model.trajectory import Array

#: after how much they begin again, in the unit in which they count, and how that is called
_DAY_S = 86_400.0
_PERIODS = {2.0**16: "a counter of 16 bits", 2.0**32: "a counter of 32 bits", _DAY_S: "midnight"}
#: units of these, against that of the stamps
_FACTORS = (1.0, 1e-3, 1e-6, 1e3, 1e6)
#: the step over the end of a period is none, or a few, of the usual ones
_STEPS = 3.0


def check(work: Work) -> None:
    """Goes on counting where a clock begins again."""
    stamps = work.start_s + work.time_s
    found = period(stamps)
    if found is None:
        return
    length, word = found
    back = np.diff(work.time_s) < 0
    work.time_s[1:] += length * np.cumsum(back)
    work.repair(
        "clock_wrap", f"the clock begins again {times(int(back.sum()))} after {length:.9g} s, as"
        f" {word} does; it was counted on", samples=np.flatnonzero(back) + 1,
        channel=work.stream.time or "",
    )  # fmt: skip


def period(stamps: Array) -> tuple[float, str] | None:
    """After how much a clock begins again, where each step back is the end of such a period."""
    back = intervals.where(stamps, lambda step: step < 0)
    usual = intervals.typical(stamps)
    if not len(back) or not usual > 0:
        return None
    before, after = stamps[back], stamps[back + 1]
    for length, word in _PERIODS.items():
        # a day is no less than 86 400 of any unit: what restarts after 86.4 s is a board
        longer = (factor for factor in _FACTORS if length != _DAY_S or factor >= 1.0)
        for whole in (length * factor for factor in longer):
            over = after - before + whole
            ends = np.abs(before - whole / 2) > whole / 2 - _STEPS * usual  # from 0, …
            ends |= np.abs(before - whole / 2) < _STEPS * usual  # or from the negative half
            near = (over > 0) & (over <= _STEPS * usual)
            if usual < whole / 100 and (ends & near).all():
                return whole, word
    return None
