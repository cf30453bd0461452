"""Angles that begin again after a full turn: a heading jumps from 359° to 0°, or 180° to −180°.

The jump is no motion: derivatives, mean values and comparisons would all be wrong by it.
"""

from __future__ import annotations

import math

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.units import quantity
from simcompare.hardware.conditioning.values import counter_wrap
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import RawColumn

#: largest step of an angle that is slow enough to tell which way it went, in turns
_SLOW = 1 / 8
#: the ends of an angle's range are a turn apart; rounding may add so much of it
_ROUNDING = 0.005
#: steps in between that are none of a slow angle, for each jump of a turn
_OTHERS = 1.0


def check(work: Work) -> None:
    """Adds up the turns of angles that begin again."""
    for column in work.data:
        wish = work.wishes(column)
        turn = _turn(work, column)
        if turn is not None and (wish is None or wish.wraps is None):
            _judge(work, column, turn)


def _turn(work: Work, column: RawColumn) -> float | None:
    """A full turn in the numbers of the column, ``None`` where it is no angle."""
    wish = work.wishes(column)
    text = quantity.meant(column.name, wish.unit if wish is not None else column.unit)
    if not text:
        return None
    try:
        factor, _, si_unit = units.si_of(text, "")
    except InputError:
        return None  # told where it is converted
    scale = abs(factor * (wish.scale if wish is not None else 1.0))
    return 2 * math.pi / scale if si_unit == "rad" and scale > 0 else None


def _judge(work: Work, column: RawColumn, turn: float) -> None:
    low, high = intervals.extent(column.values)
    if not (1 - _SLOW) * turn <= high - low <= (1 + _ROUNDING) * turn:
        return
    at, others = counter_wrap.jumps(work, column, turn, _SLOW)
    if not len(at) or others > _OTHERS * len(at):
        return
    if others:
        work.warn(
            "angle_wrap", "jumps by a full turn, as an angle that begins again does, but also by"
            " parts of a turn; left as it is. If it begins again, say so in a mapping file (--map):"
            f' "wraps: {turn:.9g}"', samples=at, channel=column.name,
        )  # fmt: skip
        return
    # what was the end of the range is none of the values that are counted on
    column.limits = None
    counter_wrap.unwrap(work, column, turn, at, "angle_wrap")
