"""CSV and other tables of text, with any separator, decimal mark, encoding and header."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from simcompare.errors import InputError
from simcompare.hardware import joints
from simcompare.hardware.logs import profiles
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import (
    console,
    kinds,
    rate,
    restarts,
    rostopic,
    sections,
    side_by_side,
    sniff,
    time_column,
    time_parts,
)
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text import table as _table
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.logs.text.state import Table
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawLog, RawStream
from simcompare.model.recording import INFO, REPAIR, Clock, Repair

TITLE = "a table of text (CSV)"

#: rows by which a table without a header is known
_FIRST_ROWS = 50


def recognises(head: Head) -> int:
    """Low for every text that holds a table: others know better."""
    if head.members:
        return 0
    lines = _source.head_lines(head.start)
    if not lines or lines[0].lstrip().startswith(("{", "<", "[{", "[[")):
        return 0
    try:
        source = _source.source_of(head.path)
        parts = _parts(replace(source, last=len(source.head)))
    except InputError:
        return 0
    return max(_certainty(part.source) for part in parts)


def _certainty(source: _source.Source) -> int:
    try:
        layout = sniff.sniff(source)
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
    return of_layout(source, layout, mapping)


def of_layout(source: _source.Source, layout: Layout, mapping: Mapping) -> RawLog:
    """The same where the layout is known."""
    if layout.names[0][0] == "rosbagTimestamp":
        layout = replace(layout, names=tuple(rostopic.nested(layout.names, layout.hollow)))
    names = [name for name, _ in layout.names]
    found = profiles.find(Path(source.label).name, layout.preamble, layout.names, source.word)
    layout = replace(layout, names=found.names) if found else layout
    times = time_column.candidates(layout, found)
    layout = time_column.with_whole_stamps(source, layout, times)
    joined = time_parts.date_and_clock(layout)
    parts = {} if joined or mapping.time else time_parts.parts(layout)
    times = [k for k in times if k not in parts.values()]
    spare = {name for name, _ in layout.names} - _cell.wanted_names(mapping)
    spare = spare - {layout.names[k][0] for k in times} if mapping.channels else set()
    missing = found.table.missing if found else ()
    table = _table.read(source, layout, joined=joined is not None, spare=spare, missing=missing)
    repairs = [*source.repairs, *table.repairs]
    if parts and not times:
        repairs += time_parts.join(table, {word: names[k] for word, k in parts.items()})
        layout = replace(layout, names=(*layout.names, (time_parts.NAME, "s")))
        times = [len(layout.names) - 1]
    if not layout.header:
        text = f"there is no header; the columns are called {', '.join(n for n, _ in layout.names)}"
        repairs.append(Repair("no_header", INFO, text[:300]))
    about = _cell.about_of(layout.preamble)
    time, clock = time_column.choose(source.label, table, layout, times, joined, mapping, repairs)
    log = RawLog(
        [_stream(table, time, clock)],
        repairs=repairs, ignored=table.ignored, about=about,
    )  # fmt: skip
    if time is None and clock.name == time_column.NO_CLOCK:
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
    names = profiles.name([row.tolist() for row in rows if row is not None], source.word)
    fits = len(names) == len(layout.names)
    return replace(layout, names=tuple((name, "") for name in names)) if fits else layout
