"""Times of the samples in seconds, from 0."""

from __future__ import annotations

import datetime
import re
from dataclasses import replace

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping_lines import time_line
from simcompare.hardware.raw import RawColumn, room

#: what a log without unit may count in, and how much that is
_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
#: how the name of a column may end that says its unit
_ENDING = re.compile(r"[a-z)\]]?[_ .([](s|sec|seconds?|ms|msec|us|µs|μs|usec|ns|nsec)[)\]]?$")
_ENDINGS = {"ms": "ms", "us": "us", "µs": "us", "μs": "us", "ns": "ns"}
#: seconds since 1970 between 2001 and 2040
_EPOCH = (978.3e6, 2208.9e6)
#: days since 1899-12-30 and since the year 0, from 1970 to 2100, and how both are called
_DAYS = {25569: "1899-12-30, as spreadsheets count", 719529: "the year 0, as MATLAB counts"}
_UNTIL_2100 = 47_482
#: how long the samples of a device may lie apart where only the stamps can tell [s]
_USUAL = (0.9e-4, 1.1)
#: and how long they mostly do [s]
_LIKELY = 0.01
#: and at all, where a unit is given [s]
_POSSIBLE = (1e-12, 3700.0)
#: names of columns that hold dates; an update is none
_OF_DATES = re.compile(r"(?<![a-z])date", re.IGNORECASE)


def check(work: Work) -> None:
    """Makes ``work.time_s``; a unit that makes no sense is a fault, with the one that does."""
    stream = work.stream
    if stream.time is None:
        if stream.increment_s is not None:
            work.start_s = stream.start_s
            work.time_s = room(len(stream))
            work.time_s[:] = np.arange(len(stream)) * stream.increment_s
        return
    if stream.time not in [column.name for column in stream.columns]:
        return  # ``prepare`` has said so
    column = stream.column(stream.time)
    factor = _factor(work, column)
    if factor is not None:
        _make(work, column, factor)


def _factor(work: Work, column: RawColumn) -> float | None:
    """Seconds in one unit of the column, ``None`` after a fault."""
    if not np.isfinite(column.values).any():
        work.fault("holds no times", channel=column.name)
        return None
    step = intervals.typical(column.values)
    first = float(column.values[np.argmax(np.isfinite(column.values))])
    ending = _ENDING.search(column.name)
    if not column.unit and ending:
        column.unit = _ENDINGS.get(ending[1][:2], "s")
    if not column.unit:
        return _without_unit(work, column, step, first)
    try:
        factor, offset, unit = units.si_of(column.unit, "time")
    except InputError as error:
        work.fault("; ".join(error.faults), channel=column.name)
        return None
    if unit != "s" or offset:
        work.fault(
            f"is the time but in {column.unit!r}; expected a unit of time such as s or ms",
            channel=column.name,
        )
        return None
    is_stated = work.mapping.time is not None and work.mapping.time.unit is not None
    return factor if is_stated else _contradicted(work, column, step, first, factor)


def _without_unit(work: Work, column: RawColumn, step: float, first: float) -> float | None:
    days = _days(column, step, first)
    if days is not None:
        work.info(
            "day_numbers", f"numbers are days since {_DAYS[days]}; the first is"
            f" {_moment((first - days) * 86_400)}", channel=column.name,
        )  # fmt: skip
        rounded_s = float(np.spacing(first)) * 86_400
        work.u_time_s = float(np.hypot(work.u_time_s, rounded_s / np.sqrt(12)))
        column.values -= days
        return 86_400.0
    name = epoch_unit(first)
    if name is not None and _possible(step * _UNITS[name]):
        work.info(
            "time_unit", f"the times have no unit; {first:.0f} is {_date(first * _UNITS[name])}"
            f" counted in {name} since 1970, so they are in {name}", channel=column.name,
        )  # fmt: skip
        return _UNITS[name]
    # steps below one are fractions of a second: clocks that count in ms, µs or ns count whole ones
    if step == 0.0 or (step < 1.0 and not intervals.whole_numbers(column)):
        work.info(
            "time_unit", "the times have no unit; taken as seconds, as the samples lie"
            f" {_length(step)} apart then", channel=column.name, after={"median_dt_s": step},
        )  # fmt: skip
        return 1.0
    return _decide(work, column, step, "have no unit")


def _days(column: RawColumn, step: float, first: float) -> int | None:
    """From when on a column counts days, where its name speaks of a date or its steps say it."""
    since = next((day for day in _DAYS if day <= first < day + _UNTIL_2100), None)
    far = step * 86_400 >= _USUAL[0] and step < _USUAL[0]
    named = _OF_DATES.search(column.name) is not None and _possible(step * 86_400)
    return since if named or far else None


def _contradicted(
    work: Work, column: RawColumn, step: float, first: float, factor: float
) -> float | None:
    """The factor of a declared unit, unless the stamps cannot be in it."""
    epoch = epoch_unit(first)
    # a date in the far future, or stamps of 2001 to 2040 at a rate that no other reading explains
    future = abs(first) * factor > 4 * _EPOCH[1] and epoch is not None
    elsewhere = (
        epoch is not None
        and _UNITS[epoch] > 10 * factor
        and step * factor < _USUAL[0]
        and _USUAL[0] <= step * _UNITS[epoch] <= _USUAL[1]
    )
    if step == 0.0 or (_possible(step * factor) and not future and not elsewhere):
        return factor
    return _decide(work, column, step, f"are said to be in {column.unit}", epoch)


def _decide(
    work: Work, column: RawColumn, step: float, what: str, epoch: str | None = None
) -> float | None:
    """A fault with a suggestion; the one unit that fits where the user lets us assume it."""
    fitting = [epoch] if epoch else [
        name for name, factor in _UNITS.items() if _USUAL[0] <= step * factor <= _USUAL[1]
    ]  # fmt: skip
    stated = column.unit or "s"
    now = f"the times {what}; "
    if stated in _UNITS or not column.unit:
        now += f"in {stated} the samples would lie {_length(step * _UNITS.get(stated, 1.0))} apart"
    else:
        now += f"neighbours differ by {step:.6g}"
    fits = " or ".join(f"in {name}, {_length(step * _UNITS[name])} apart" for name in fitting)
    if work.assume_units and len(fitting) == 1:
        work.repair(
            "time_unit", f"{now}; taken {fits}", channel=column.name,
            before={"median_dt_s": step * _UNITS.get(stated, 1.0)},
            after={"median_dt_s": step * _UNITS[fitting[0]]},
        )  # fmt: skip
        return _UNITS[fitting[0]]
    best = min(fitting, key=lambda name: abs(np.log(step * _UNITS[name] / _LIKELY)), default="s")
    if "s" in fitting and not intervals.whole_numbers(column):
        best = "s"  # what counts in ms, µs or ns counts whole ones
    how = f"write into a mapping file (--map): {time_line(column.name, best)}"
    guess = f" ({fits})" if fits else ""
    work.fault(f"{now}{guess}; {how}", channel=column.name)
    return None


def _make(work: Work, column: RawColumn, factor: float) -> None:
    """Turns the column into seconds from its first stamp, in its own memory."""
    values = column.values
    first = float(values[np.argmax(np.isfinite(values))])
    values -= first
    values *= factor
    work.time_s, work.start_s = values, first * factor
    date = _date(work.start_s)
    if date and not work.stream.clock.start:
        work.stream.clock = replace(work.stream.clock, start=date)


def epoch_unit(first: float) -> str | None:
    """Unit in which a stamp counts from 1970 to a day between 2001 and 2040."""
    return next(
        (name for name, f in _UNITS.items() if _EPOCH[0] <= first * f <= _EPOCH[1]), None
    )  # fmt: skip


def _date(seconds: float) -> str:
    return _moment(seconds) if _EPOCH[0] <= seconds <= _EPOCH[1] else ""


def _moment(seconds: float) -> str:
    since_1970 = datetime.timedelta(seconds=seconds)
    moment = datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC) + since_1970
    return moment.isoformat(timespec="milliseconds")


def _possible(step_s: float) -> bool:
    return _POSSIBLE[0] <= step_s <= _POSSIBLE[1]


def _length(seconds: float) -> str:
    for name, factor in _UNITS.items():
        if seconds >= factor:
            return f"{seconds / factor:.4g} {name}"
    return f"{seconds:.4g} s"
