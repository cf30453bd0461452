"""CSV and other tables of text, with any separator, decimal mark, encoding and header."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware import joints, proposed_time
from simcompare.hardware.logs import profiles
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import (
    clocks,
    console,
    kinds,
    rate,
    restarts,
    rostopic,
    sections,
    side_by_side,
    sniff,
    time_parts,
)
from simcompare.hardware.logs.text import dates as _dates
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text import table as _table
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.logs.text.state import Table
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream
from simcompare.model.recording import INFO, REPAIR, Clock, Repair

TITLE = "a table of text (CSV)"

#: name of a clock that nothing tells
NO_CLOCK = "no clock"
#: rows by which a table without a header is known
_FIRST_ROWS = 50
#: nanoseconds from 1970 to 2000 and to 2100
_Y2000, _Y2100 = 946_684_800 * 10**9, 4_102_444_800 * 10**9


def recognises(head: Head) -> int:
    """Low for every text that holds a table: others know better."""
    if head.members:
        return 0
    lines = _source.head_lines(head.start)
    if not lines or lines[0].lstrip().startswith(("{", "<", "[{", "[[")):
        return 0
    try:
        layout = sniff.sniff(_parts(_source.source_of(head.path))[0].source)
    except InputError as error:
        # a table in which something is wrong: its reader says what
        return 5 if any("line " in fault for fault in error.faults) else 0
    if rostopic.is_echo([name for name, _ in layout.names]):
        return 40
    return 20 if len(layout.kinds) > 1 else 5


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads a table.

    Raises:
        InputError: every fault with its line and column, up to twenty, then their number.
    """
    parts = _parts(_source.source_of(path))
    if len(parts) == 1:
        log = read_source(parts[0].source, mapping)
        log.repairs += parts[0].repairs
        return log
    return _together(str(path), parts, mapping)


def _parts(source: _source.Source) -> list[_source.Part]:
    """The tables of a file: by the kinds of its rows, or below each other."""
    plain = console.unrolled(source)
    if plain.labels:
        return [_source.Part("", plain)]
    of_kinds = [replace(p, source=console.unrolled(p.source)) for p in kinds.of(plain)]
    return of_kinds or sections.of(plain)


def _together(label: str, parts: Sequence[_source.Part], mapping: Mapping) -> RawLog:
    """A stream for each part; one that is no table, or has no clock, is left out and told."""
    log = RawLog([])
    without: list[RawStream] = []
    for part in parts:
        log.repairs += part.repairs
        try:
            one = read_source(part.source, mapping)
        except InputError as error:
            fault = error.faults[0]
            log.repairs.append(_no_stream(part.name, fault))
            continue
        for stream in one.streams:
            several = len(one.streams) > 1
            stream.name = f"{part.name}_{stream.name}" if several else part.name
            timed = stream.time is not None or stream.increment_s or stream.name in mapping.streams
            (log.streams if timed else without).append(stream)
        told = (r for r in one.repairs if r not in log.repairs and r.rule != "blank_line")
        log.repairs += [replace(r, stream=part.name) for r in told]
        log.ignored |= {f"{part.name}/{name}": why for name, why in one.ignored.items()}
        log.about |= {**one.about, **log.about}
    if log.streams:
        log.repairs += [_no_stream(s.name, "no column of it is a time") for s in without]
    log.streams = log.streams or without
    if not log.streams:
        read_source(parts[0].source, mapping)  # raises what is wrong with it
    return log


def _no_stream(name: str, why: str) -> Repair:
    return Repair("left_out_table", REPAIR, f"table {name} was left out: {why}"[:300])


def read_source(source: _source.Source, mapping: Mapping) -> RawLog:
    """The same for a file within an archive."""
    layout = sniff.sniff(source, _cell.wanted_names(mapping))
    if len(source.labels) == len(layout.names):
        layout = replace(layout, names=_cell.labelled(source.labels), header="labels")
    if not layout.header:
        layout = _named_by_numbers(source, layout)
    names = [name for name, _ in layout.names]
    found = profiles.find(Path(source.label).name, layout.preamble, layout.names)
    layout = replace(layout, names=found.names) if found else layout
    times = _time_columns(layout, found)
    layout = _with_integer_stamps(source, layout, times)
    joined = _date_and_clock(layout)
    parts = {} if joined or mapping.time else time_parts.parts(layout)
    times = [k for k in times if k not in parts.values()]
    spare = {name for name, _ in layout.names} - _cell.wanted_names(mapping)
    spare = spare - {layout.names[k][0] for k in times} if mapping.channels else set()
    table = _table.read(source, layout, joined=joined is not None, spare=spare)
    repairs = [*source.repairs, *table.repairs]
    if parts and not times:
        repairs += time_parts.join(table, {word: names[k] for word, k in parts.items()})
        layout = replace(layout, names=(*layout.names, (time_parts.NAME, "s")))
        times = [len(layout.names) - 1]
    if not layout.header:
        text = f"there is no header; the columns are called {', '.join(n for n, _ in layout.names)}"
        repairs.append(Repair("no_header", INFO, text[:300]))
    about = _cell.about_of(layout.preamble)
    time, clock = _time(source.label, table, layout, times, joined, mapping, repairs)
    log = RawLog(
        [_stream(table, time, clock)],
        repairs=repairs, ignored=table.ignored, about=about,
    )  # fmt: skip
    if time is None and clock.name == NO_CLOCK:
        _with_rate(log, found)
    if rostopic.is_echo(names):
        rostopic.finish(log)
    if found:
        found.finish(log)
    joints.mark(log.streams[0].columns)
    if mapping.time is None and joined is None:
        side_by_side.split(log, [layout.names[k][0] for k in times])
    restarts.split(log)
    return log


def _stream(table: Table, time: str | None, clock: Clock) -> RawStream:
    """All columns with one clock."""
    return RawStream("log", table.columns, time, clock=clock, first_row=table.first_row,
                     rows=table.rows, truncated=table.truncated)  # fmt: skip


def _with_rate(log: RawLog, found: profiles.Found | None) -> None:
    """Gives the samples the rate that the head of the log says, where it says one."""
    said = rate.of(log.about)
    if found and found.rate_Hz:
        said = found.rate_Hz, ""
    if said:
        log.streams[0].increment_s = 1 / said[0]
        log.streams[0].clock = Clock(f"{said[0]:g} Hz, as the head of the log says")
        text = f"no column is a time; {said[1]!r} says that there are {said[0]:g} rows in a second"
        log.repairs += [Repair("rate", INFO, text)] if said[1] else []


def _named_by_numbers(source: _source.Source, layout: Layout) -> Layout:
    """Names for columns without a header, where the first rows tell what they are."""
    lines = source.head_from(layout.first_line)[:_FIRST_ROWS]
    cells = [_cell.split(line, layout.separator) for line in lines if line.strip()]
    rows = [_cell.numbers(row, layout.decimal) for row in cells]
    names = profiles.name([row.tolist() for row in rows if row is not None])
    fits = len(names) == len(layout.names)
    return replace(layout, names=tuple((name, "") for name in names)) if fits else layout


def _time_columns(layout: Layout, found: profiles.Found | None) -> list[int]:
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


def _with_integer_stamps(source: _source.Source, layout: Layout, times: Sequence[int]) -> Layout:
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


def _date_and_clock(layout: Layout) -> tuple[str, str] | None:
    """Names of a column of dates and one of times of day that belong together."""
    dates = [k for k, style in layout.styles.items() if style.kind != "clock"]
    clocks = [k for k, style in layout.styles.items() if style.kind == "clock"]
    if len(dates) == 1 and len(clocks) == 1:
        return layout.names[dates[0]][0], layout.names[clocks[0]][0]
    return None


def _time(
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
        _join(table, joined)
        names = [name for name in names if name not in joined] or [joined[1]]
    if mapping.time is not None and mapping.time.columns:
        names = [*mapping.time.columns]
    columns = [c for c in table.columns if c.name in names]
    few = len(columns[0].values) < proposed_time.FEW_ROWS if columns else False
    if few and mapping.time is None:
        columns = [c for c in columns if not clocks.is_period(c.name)]  # of a table of results
    if not columns:
        return None, Clock(NO_CLOCK)
    column = clocks.same(columns) if len(columns) > 1 else columns[0]
    if column is None and side_by_side.blocks(table.columns, names):
        column = columns[0]
        columns = [column]
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


def _join(table: Table, joined: tuple[str, str]) -> None:
    """Adds the column of dates to that of the times of day."""
    date, clock = (next(c for c in table.columns if c.name == name) for name in joined)
    clock.values += date.values
    table.origins[clock.name] += table.origins[date.name]
    table.columns.remove(date)
    table.ignored[date.name] = f"was added to column {clock.name!r}"
