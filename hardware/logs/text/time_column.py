"""Which column of a text table is its time, and when it began."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware import proposed_time
from simcompare.hardware.logs import profiles
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import clocks, console, side_by_side, time_parts
from simcompare.hardware.logs.text import dates as _dates
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.logs.text.state import Table
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import RawColumn
from simcompare.model.recording import INFO, Clock, Repair

#: name of a clock that nothing tells
NO_CLOCK = "no clock"
#: the share of rows in which a clock is read
_WHOLE = 0.5
#: nanoseconds from 1970 to 2000 and to 2100
_Y2000, _Y2100 = 946_684_800 * 10**9, 4_102_444_800 * 10**9


def candidates(layout: Layout, found: profiles.Found | None) -> list[int]:
    """Columns that may be the time by name and unit, or by being the only one in such a unit."""
    usable = [k for k, kind in enumerate(layout.kinds) if kind in ("number", "date")]
    usable = [k for k in usable if k not in layout.hollow]
    if found and found.table.time:
        told = [k for k in usable if re.fullmatch(found.table.time, layout.names[k][0])]
        if told:
            return told
    ros = [k for k in usable if layout.names[k][0] == "field.header.stamp"]
    if ros:
        return ros
    # T [Nm] is a torque, and beside t a T is a temperature
    usable = [k for k in usable if not layout.names[k][1] or _in_time(layout, k)]
    timed = [k for k in usable if _in_time(layout, k)]
    for says_so in (clocks.is_time, clocks.may_be_time):
        named = [k for k in usable if says_so(layout.names[k][0])]
        if named:  # the clock of a device goes before that of its console
            named = [k for k in named if layout.names[k][0] != console.STAMP] or named
            return [k for k in named if layout.names[k] != ("T", "")] or named
    timed = [k for k in timed if not clocks.is_span(layout.names[k][0])]
    return timed if len(timed) == 1 else []


def _in_time(layout: Layout, k: int) -> bool:
    return layout.kinds[k] == "date" or _is_time_unit(layout.names[k][1])


def _is_time_unit(unit: str) -> bool:
    if not unit:
        return False
    try:
        return units.si_of(unit, "")[2] == "s"
    except InputError:
        return False


def with_whole_stamps(source: _source.Source, layout: Layout, times: Sequence[int]) -> Layout:
    """Stamps of 16 digits and more are read as whole numbers: a float would round them."""
    rows = source.head_from(layout.first_line)
    if not rows:
        return layout
    kinds = list(layout.kinds)
    cells = _cell.split(rows[0], layout.separator)
    ros = [0] if layout.names[0][0] == "%time" else []
    for k in [*times, *ros]:
        if kinds[k] == "number" and k < len(cells) and re.fullmatch(r"\s*\d{16,19}\s*", cells[k]):
            kinds[k] = "integer"
    return replace(layout, kinds=tuple(kinds))


def choose(
    label: str,
    table: Table,
    layout: Layout,
    times: Sequence[int],
    joined: tuple[str, str] | None,
    mapping: Mapping,
    repairs: list[Repair],
) -> tuple[str | None, Clock]:
    """Which column is the time and where its clock stands."""
    if mapping.time is not None and mapping.time.rate_Hz is not None:
        return None, Clock(f"{mapping.time.rate_Hz:g} Hz")
    names = [layout.names[k][0] for k in times]
    if joined is not None:
        time_parts.add_date(table, joined)
        names = [name for name in names if name not in joined] or [joined[1]]
    if mapping.time is not None and mapping.time.columns:
        names = [*mapping.time.columns]
    columns = [c for c in table.columns if c.name in names]
    few = len(columns[0].values) < proposed_time.FEW_ROWS if columns else False
    if few and mapping.time is None:
        columns = [c for c in columns if not clocks.is_period(c.name)]  # of a table of results
    if not columns:
        return None, Clock(NO_CLOCK)
    columns = _moving(table, columns)
    column = clocks.same(columns) if len(columns) > 1 else columns[0]
    if column is None and side_by_side.blocks(table.columns, names):
        column = columns[0]
        columns = [column]
    whole = [c for c in columns if np.isfinite(c.values).mean() > _WHOLE]
    if column is None and len(whole) == 1:  # the other one is empty but for a few rows
        columns = whole
        column = whole[0]
    if column is None:
        raise InputError(label, [proposed_time.several(columns)])
    if len(columns) > 1:
        others = ", ".join(repr(c.name) for c in columns if c is not column)
        text = f"the clock is {column.name!r}; {others} tells the same time"
        repairs.append(Repair("clock", INFO, text, channel=column.name))
    k = next((k for k, (name, _) in enumerate(layout.names) if name == column.name), -1)
    column.unit = column.unit or clocks.unit_of_time(column.name)
    start = _started(table, layout, column, k, repairs)
    return column.name, Clock(f"column {column.name}", start)


def _moving(table: Table, columns: list[RawColumn]) -> list[RawColumn]:
    """Those that change; the date of a log, the same in all rows, is no clock beside them."""
    still = [c for c in columns if not np.any(c.values != c.values[0])]
    if len(still) == len(columns):
        return columns
    for column in still:
        table.columns.remove(column)
        table.ignored[column.name] = "is the same in all rows"
    return [c for c in columns if c not in still]


def _started(table: Table, layout: Layout, column: RawColumn, k: int, repairs: list[Repair]) -> str:
    """When the log began, for dates and for stamps that count from 1970."""
    style, origin = layout.styles.get(k), table.origins.get(column.name)
    if style is not None and origin is not None:
        if origin < style.period_ns:
            what = "times of day" if style.kind == "clock" else style.words
            text = f"the column holds {what}; they were read as seconds since the first"
            repairs.append(Repair("time_of_day", INFO, text, channel=column.name))
            return ""
        text = f"dates ({style.words}) were read as seconds since {_dates.iso(origin)}"
        start = _dates.iso(origin)
        if style.other:
            other = replace(style, order=style.other).words
            text, start = f"dates were read as seconds since the first; they may be {other}", ""
        repairs.append(Repair("date_text", INFO, text, channel=column.name))
        return start
    if origin is not None:
        return _epoch(column, origin, repairs)
    return ""


def _epoch(column: RawColumn, origin: int, repairs: list[Repair]) -> str:
    """Stamps that count nano- or microseconds from 1970 have had their first value taken away."""
    # 1970 is far away for logs: what lies between 2000 and 2100 says its unit
    fitting = (u for u, factor in (("ns", 1), ("us", 1000)) if _Y2000 < origin * factor < _Y2100)
    unit = next(fitting, "")
    text = f"the first stamp, {origin}, was taken away from all, as a float would round them"
    start = ""
    if unit and column.unit in ("", unit):
        start = _dates.iso(origin * (1 if unit == "ns" else 1000))
        text += f"; counted in {unit} from 1970 it is {start}"
        column.unit = unit
    repairs.append(Repair("large_stamps", INFO, text, channel=column.name))
    return start
