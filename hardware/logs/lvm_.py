"""LabVIEW measurement files (LVM): a header, and one or more segments of columns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text import table as _table
from simcompare.hardware.logs.text.marks import marks as decimal_marks
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.logs.text.state import Table
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream, told_apart
from simcompare.model.recording import WARNING, Clock, Repair
from simcompare.model.trajectory import Array

TITLE = "a LabVIEW measurement file (LVM)"

_END = "***End_of_Header***"
#: rows of a segment that are looked at before it is read
_SAMPLE = 300
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}
#: units as LabVIEW spells them
_UNITS = {
    "volts": "V", "volt": "V", "amps": "A", "amperes": "A", "newtons": "N", "newton": "N",
    "newton-meters": "N*m", "meters": "m", "seconds": "s", "pascals": "Pa", "watts": "W",
    "deg c": "degC", "hertz": "Hz", "radians": "rad", "degrees": "deg", "ohms": "ohm",
}  # fmt: skip


@dataclass
class _Segment:
    """One header and the rows below it."""

    fields: dict[str, list[str]] = field(default_factory=dict)
    names: list[str] = field(default_factory=list)
    first: int = 0
    last: int = 0
    sample: list[str] = field(default_factory=list)

    def of(self, key: str, i: int) -> str:
        """Entry of a header field for one channel."""
        values = [value.strip() for value in self.fields.get(key, [])]
        # beside a column of X for each channel, every second cell is empty
        place = 2 * i if self.names[:1] == self.names[2:3] == ["X_Value"] else i
        return values[place] if place < len(values) else ""


def recognises(head: Head) -> int:
    """Certain by its first line."""
    lines = _source.head_lines(head.start) if not head.members else []
    return 99 if lines and lines[0].startswith("LabVIEW Measurement") else 0


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all segments; each is a stream, or one for each channel where these differ in time.

    Raises:
        InputError: a damaged header, or rows that are no numbers.
    """
    source = _source.source_of(path)
    parts = _Parts(source)
    general, segments = parts.general, parts.segments
    if not segments:
        raise InputError(str(path), [f"line 1: no segment of data follows; expected {_END} twice"])
    log = RawLog([], repairs=list(source.repairs))
    log.about = {key: values[0] for key, values in general.items() if values and values[0]}
    for number, segment in enumerate(segments, start=1):
        prefix = f"segment_{number}" if len(segments) > 1 else "log"
        _add(log, source, general, segment, prefix)
    return log


class _Parts:
    """Headers and where the rows stand; the rows themselves are not kept."""

    def __init__(self, source: _source.Source) -> None:
        self.source = source
        self.general: dict[str, list[str]] = {}
        self.segments: list[_Segment] = []
        self.separator = "\t"
        self._open = _Segment()
        self._take = self._in_general
        for block in _source.blocks(source):
            for at, line in enumerate(block.lines, start=block.line):
                self._one(at, line)

    def _one(self, at: int, line: str) -> None:
        if self._take == self._in_rows and line[:3] != "***" and line.strip():
            self._open.last = at  # the great mass of the lines
            if len(self._open.sample) < _SAMPLE:
                self._open.sample.append(line)
            return
        word = line.split(self.separator)[0].strip()
        if word == "***Start_Special***":
            self._after_special, self._take = self._take, self._in_special
        else:
            self._take(at, line, word)

    def _in_special(self, at: int, line: str, word: str) -> None:
        if word == "***End_Special***":
            self._take = self._after_special

    def _in_general(self, at: int, line: str, word: str) -> None:
        if word == _END:
            self._take = self._in_header
        elif word:
            key, *values = re.split(r"[\t,;]", line, maxsplit=1)
            self.general[key.strip()] = [value.strip("\t ") for value in values]
            self.separator = _separator(self.source.label, self.general)

    def _in_header(self, at: int, line: str, word: str) -> None:
        if word == _END:
            self._take = self._in_names
        elif word:
            key, *values = line.split(self.separator)
            self._open.fields[key.strip()] = values

    def _in_names(self, at: int, line: str, word: str) -> None:
        self._open.names = [cell.strip() for cell in line.split(self.separator)]
        self._open.first, self._open.last = at + 1, at
        self.segments.append(self._open)
        self._take = self._in_rows

    def _in_rows(self, at: int, line: str, word: str) -> None:
        """An empty line: the segment is at its end."""
        self._open = _Segment()
        self._take = self._in_header
        if word:
            self._in_header(at, line, word)


def _separator(label: str, general: dict[str, list[str]]) -> str:
    stated = (general.get("Separator") or ["Tab"])[0].strip()
    separator = _SEPARATORS.get(stated.lower(), stated)
    if separator not in (*_SEPARATORS.values(), ""):
        raise InputError(label, [f"Separator is {stated!r}; expected Tab, Comma or Semicolon"])
    return separator or "\t"


def _add(
    log: RawLog,
    source: _source.Source,
    general: dict[str, list[str]],
    segment: _Segment,
    prefix: str,
) -> None:
    """Adds the streams of one segment."""
    separator = _separator(source.label, general)
    x_columns = (general.get("X_Columns") or ["One"])[0].strip().lower() or "one"
    layout = _layout(source.label, general, segment, separator, x_columns)
    table = _table.read(replace(source, last=segment.last), layout)
    log.repairs += table.repairs
    log.ignored.update({f"{prefix}/{name}": why for name, why in table.ignored.items() if name})
    log.ignored.pop(f"{prefix}/X_Value", None)
    channels = _channels(segment, x_columns)
    clocks = [_clock(segment, i) for i in range(len(channels))]
    groups: dict[object, list[int]] = {}
    by_name = {column.name: column.values for column in table.columns}
    for i, (_, x_name) in enumerate(channels):
        steps = (segment.of("X0", i), segment.of("Delta_X", i), segment.of("Samples", i))
        key = (clocks[i], *steps, _first_alike(x_name, [x for _, x in channels], by_name))
        groups.setdefault(key if x_columns != "one" else "one", []).append(i)
    for members in groups.values():
        name = prefix if len(groups) == 1 else f"{prefix}_{channels[members[0]][0]}"
        log.streams.append(
            _stream(log, table, segment, name, x_columns, [(i, *channels[i]) for i in members])
        )


def _channels(segment: _Segment, x_columns: str) -> list[tuple[str, str]]:
    """Name of each channel and of its column of X (empty where it has none)."""
    names = segment.names[:-1] if segment.names[-1:] == ["Comment"] else segment.names
    names = [name for name in names if name]
    if x_columns == "multi":
        unique = told_apart(names)
        return list(zip(unique[1::2], unique[0::2], strict=False))
    return [(name, "X_Value" if x_columns == "one" else "") for name in told_apart(names[1:])]


def _first_alike(name: str, names: Sequence[str], values: dict[str, Array]) -> str:
    """The first column of X that holds the same as this one."""
    mine = values.get(name)
    if mine is None:
        return ""
    return next(n for n in names if np.array_equal(values[n], mine, equal_nan=True))


def _layout(
    label: str, general: dict[str, list[str]], segment: _Segment, separator: str, x_columns: str
) -> Layout:
    """All columns as numbers, but for an empty first one and the comments."""
    names = told_apart([name for name in segment.names if name])
    if not names:
        raise InputError(
            label, [f"line {segment.first - 1}: no names of columns; expected X_Value"]
        )
    kinds = ["number"] * len(names)
    if names and names[-1] == "Comment":
        kinds[-1] = "text"
    if x_columns == "no":
        kinds[0] = "empty"
    rows = [(segment.first + i, line.split(separator)) for i, line in enumerate(segment.sample)]
    if not rows:
        raise InputError(label, [f"line {segment.first}: no samples follow the header"])
    # rows without a comment end before it, and may end with a separator
    width = max(len(cells) for _, cells in rows)
    if width == len(names) - 1 and kinds[-1] == "text":
        names, kinds = names[:-1], kinds[:-1]
    kinds += ["empty"] * (width - len(names))
    names += [""] * (len(kinds) - len(names))
    full = tuple((name, "") for name in names)
    stated = (general.get("Decimal_Separator") or [""])[0].strip()
    is_stated = stated in (".", ",")
    marks = (stated, "", True) if is_stated else decimal_marks(label, rows, kinds, full)
    return Layout(separator, segment.first, tuple(kinds), full, *marks, short_rows=True)


def _clock(segment: _Segment, i: int) -> str:
    """When a channel began, ISO 8601."""
    date = segment.of("Date", i).replace("/", "-")
    clock = re.sub(r"[.,](\d{1,6})\d*$", r".\1", segment.of("Time", i).replace(",", "."))
    return f"{date}T{clock}" if date and clock else date


def _stream(
    log: RawLog,
    table: Table,
    segment: _Segment,
    name: str,
    x_columns: str,
    channels: Sequence[tuple[int, str, str]],
) -> RawStream:
    by_name = {column.name: column for column in table.columns}
    columns = []
    for i, channel, _ in channels:
        if channel in by_name:
            stated = segment.of("Y_Unit_Label", i)
            source = by_name[channel]
            unit = _UNITS.get(stated.lower(), stated)
            columns.append(RawColumn(channel, source.values, unit))
    first, x_name = channels[0][0], channels[0][2]
    clock = Clock("LabVIEW", _clock(segment, first))
    promised = _cell.number(segment.of("Samples", first)) or 0.0
    rows, values = table.rows, columns[0].values if columns else np.empty(0)
    count = len(values)
    if 0 < promised < count:
        more = any(not np.isnan(column.values[int(promised) :]).all() for column in columns)
        if more:
            text = f"its header promises {promised:g} samples, and {count} are there; all were kept"
            log.repairs.append(Repair("more_samples", WARNING, text, name))
        else:  # shorter channels end before the longest
            count = int(promised)
    stream = RawStream(
        name, columns, clock=clock, first_row=table.first_row,
        rows=None if rows is None else rows[:count], truncated=table.truncated,
    )  # fmt: skip
    for column in columns:
        column.values = column.values[:count]
    if promised > count:
        stream.truncated = stream.truncated or (
            f"holds {count} of the {promised:g} samples that its header promises"
        )
    step = _cell.number(segment.of("Delta_X", first).replace(",", "."))
    if x_name and x_name in by_name:
        time = RawColumn("X_Value", by_name[x_name].values[:count], "s")
        stream.columns.insert(0, time)
        stream.time = "X_Value"
    elif step is not None and 0 < step < np.inf:
        start = _cell.number(segment.of("X0", first).replace(",", "."))
        stream.increment_s = step
        stream.start_s = start if start is not None and np.isfinite(start) else 0.0
    dimension = segment.of("X_Dimension", first)
    if dimension and dimension.lower() != "time":
        text = f"the X axis is {dimension!r}, not time; it was taken as seconds"
        log.repairs.append(Repair("x_dimension", WARNING, text, name))
    return stream
