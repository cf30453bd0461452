"""What to write where a log does not say which column is its time: one line that opens it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.conditioning.clock import sample_counter, time_unit
from simcompare.hardware.conditioning.units import quantity
from simcompare.hardware.logs.text import clocks
from simcompare.hardware.mapping_lines import time_line
from simcompare.hardware.raw import RawColumn, RawStream

#: a table of results has fewer rows than a log
FEW_ROWS = 60
#: columns that are named
_SHOWN = 12
#: steps of whole numbers that are milliseconds; smaller ones are seconds, larger ones microseconds
_MILLISECONDS = (2.0, 2000.0)


def no_time(stream: RawStream) -> str:
    """What to say of a stream in which no column is the time."""
    shown = [column.name for column in stream.columns[:_SHOWN]]
    names = ", ".join([*shown, "…"] if len(stream.columns) > _SHOWN else shown)
    spans = [c for c in stream.columns if clocks.is_span(c.name) and _unit(c) == "s"]
    if spans and len(stream) < FEW_ROWS:
        letter = clocks.is_period(spans[0].name)
        way_out = f". If it is the time all the same: {_line(spans[0])}" if letter else ""
        return (
            f"no column is a time: {spans[0].name!r} says how long something takes. {len(stream)}"
            f" rows of {names} are a table of results, no log of samples{way_out}"
        )
    likely = next((column for column in stream.columns if _likely(column)), None)
    if likely is not None:
        return (
            f"no column is a time (columns: {names}); {likely.name!r} increases from row to row"
            f" and may be it. If so, write into a mapping file (--map): {_line(likely)}"
        )
    return (
        f"no column is a time (columns: {names}). If the samples are evenly spaced, write into a"
        " mapping file (--map), with as many samples a second as there were: time: {rate_Hz: 100}"
    )


def several(columns: Sequence[RawColumn]) -> str:
    """What to say where several columns may be the time; the one that reads best is proposed."""
    named = " and ".join(repr(column.name) for column in columns[:4])
    sound = [column for column in columns if _increases(column)] or [*columns]
    best = min(sound, key=lambda column: not column.unit)
    return (
        f"columns {named} may all be the time; say which in a mapping file (--map), such as"
        f" {_line(best)}"
    )


def _line(column: RawColumn) -> str:
    return time_line(column.name, column.unit or _likely_unit(column))


def _likely_unit(column: RawColumn) -> str:
    """Boards count whole milli- or microseconds."""
    steps = np.diff(column.values)
    if not len(steps):
        return ""  # what is not read yet is settled by its content
    step = float(np.median(steps))
    since_1970 = time_unit.epoch_unit(float(column.values[0]))
    if since_1970:
        return since_1970
    if step != round(step) or step < _MILLISECONDS[0]:
        return "s"
    return "ms" if step <= _MILLISECONDS[1] else "us" if step < 1e6 else "ns"


def _likely(column: RawColumn) -> bool:
    """Whether a column increases, has no other unit, and counts no rows."""
    if _unit(column) not in ("", "s") or clocks.is_span(column.name):
        return False
    if sample_counter.is_named(column.name) or not _increases(column):
        return False
    if quantity.possible(column.name) - {"s"}:
        return False  # phi may increase too
    # 0, 1, 2 … are the numbers of the rows
    return not (column.values == np.round(column.values)).all() or (
        float(np.median(np.diff(column.values))) > 1 and not _counts(column)
    )


def _counts(column: RawColumn) -> bool:
    """Whether all steps are multiples of the same small one, as in numbers of films and packets."""
    steps = np.diff(column.values)
    return bool(steps.min() <= 4 and (steps % steps.min() == 0).all())


def _increases(column: RawColumn) -> bool:
    """Whether every value is larger than the one before."""
    return len(column.values) > 2 and bool((np.diff(column.values) > 0).all())


def _unit(column: RawColumn) -> str:
    """In SI, empty where nothing is said, the raw one where it is not understood."""
    try:
        return units.si_of(column.unit, "")[2] if column.unit else ""
    except InputError:
        return column.unit
