"""Exports of the phyphox app: one CSV, a zip with one CSV for each sensor, or the unzipped folder.

    "Time (s)","Acceleration x (m/s^2)","Acceleration y (m/s^2)",…
    9.364549000E-3,1.003170490E0,3.543418407E0,…

``meta/device.csv`` describes the phone, ``meta/time.csv`` when it started and paused.
"""

from __future__ import annotations

import datetime
import itertools
import re
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import zip_guard
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import sniff
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text import table as _table
from simcompare.hardware.logs.text.state import Table
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream
from simcompare.model.recording import INFO, WARNING, Clock, Event, Repair

TITLE = "an export of phyphox"

_QUOTED = re.compile(r'"Time \(s\)"[,;\t]"|"(Bounce 0|Start) \(s\)"[,;\t]"(Height 0|Stop)')
#: columns that are phyphox's also where a spreadsheet has taken the quotes away
_KNOWN = re.compile(
    r"Time \(s\)[,;\t]((Linear )?Acceleration x \(m/s\^2\)|Gyroscope x \(rad/s\)"
    r"|Magnetic [Ff]ield x \(.T\))"
)
#: name of the table where there is one file alone
_ALONE = "log.csv"
_INSTANT = re.compile(r"(Bounce|Start|Stop)(?: (\d+))?")
_KINDS = (
    (re.compile(r"(linear acceleration|absolute linear)", re.IGNORECASE), "gravity_removed"),
    (re.compile(r"acceleration", re.IGNORECASE), "specific_force"),
)
#: first word of a column -> name of the sensor in meta/device.csv
_SENSORS = {
    "Linear": "linear_acceleration", "Acceleration": "accelerometer", "Gyroscope": "gyroscope",
    "Magnetic": "magnetic_field", "Pressure": "pressure", "Illuminance": "light",
    "Proximity": "proximity", "Absolute": "",
}  # fmt: skip


def recognises(head: Head) -> int:
    """Certain with the meta files; high by the header of a single CSV."""
    names = [name.replace("\\", "/") for name in head.members]
    if any(re.search(r"(^|/)meta/(device|time)\.csv$", name) for name in names):
        return 95
    if names:
        tables = [name for name in names if name.lower().endswith(".csv")]
        return 60 if tables and head.start[:2] == b"PK" and _first_fits(head.path, tables[0]) else 0
    lines = _source.head_lines(head.start)
    return 85 if lines and (_QUOTED.match(lines[0]) or _KNOWN.match(lines[0])) else 0


def _first_fits(path: Path, member: str) -> bool:
    try:
        with zipfile.ZipFile(path) as archive, archive.open(member) as file:
            return bool(_QUOTED.match(file.read(200).decode("utf-8", errors="replace")))
    except zip_guard.ERRORS:
        return False


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads every sensor as a stream of its own.

    Raises:
        InputError: a damaged archive, or a table with faults.
    """
    log = RawLog([])
    where = str(path)
    try:
        with _members(path) as members:
            tables = {name: src for name, src in members.items() if "meta/" not in name}
            meta = {Path(name).name: src for name, src in members.items() if "meta/" in name}
            if not tables:
                raise InputError(where, ["holds no table of a sensor; expected files *.csv"])
            device = _pairs(meta.get("device.csv"))
            for name, source in tables.items():
                where = source.label
                _add(log, Path(name).stem, source, device)
            log.about |= device
            _clocks(log, meta.get("time.csv"))
    except zip_guard.ERRORS as error:
        # a member that is cut, has a wrong checksum, or is encrypted
        raise InputError(where, [f"cannot be unpacked: {error}; export it again"]) from None
    if not log.streams:
        empty = ", ".join(log.ignored)
        raise InputError(str(path), [f"no sensor has any samples ({empty})"])
    return log


@contextmanager
def _members(path: Path) -> Iterator[dict[str, _source.Source]]:
    """Every CSV of the export by its name."""
    if path.is_dir():
        files = sorted(p for p in path.rglob("*.csv") if p.is_file())
        yield {f.relative_to(path).as_posix(): _source.source_of(f) for f in files}
    elif zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as archive:
            names = [n for n in archive.namelist() if n.lower().endswith(".csv")]
            kept = [n for n in names if not n.startswith("__MACOSX")]
            yield {n: _source.opened(f"{path}/{n}", partial(archive.open, n)) for n in kept}
    else:
        yield {_ALONE: _source.source_of(path)}


def _pairs(source: _source.Source | None) -> dict[str, str]:
    """``"property","value"`` as a mapping."""
    if source is None:
        return {}
    rows = [_cell.split(line, _separator(source)) for line in source.head[1:] if line.strip()]
    return {row[0]: row[1] for row in rows if len(row) > 1 and row[1] not in ("", "null")}


def _separator(source: _source.Source) -> str:
    match = re.match(r'"[^"]*"([,;\t])|[^",;\t]*([,;\t])', "".join(source.head[:1]))
    return (match[1] or match[2]) if match else ","


def _add(log: RawLog, name: str, source: _source.Source, device: dict[str, str]) -> None:
    """Adds one table: samples of a sensor, or the instants of a stopwatch or of bounces."""
    log.repairs += source.repairs
    if not any(map(str.strip, source.head[1:])):
        log.ignored[name] = "holds no samples"
        return
    separator = _separator(source)
    names = _cell.headings(_cell.split(source.head[0], separator))
    layout = sniff.below_header(source.label, source.head, 1, names, separator)
    table = _table.read(source, layout)
    log.repairs += [replace(repair, stream=name) for repair in table.repairs]
    if _INSTANT.fullmatch(names[0][0]):
        _add_instants(log, name, table)
        return
    for column in table.columns:
        _describe(column, device)
    time = "Time" if names[0][0] == "Time" else None
    log.streams.append(
        RawStream(name, table.columns, time, clock=Clock("experiment time"),
                  first_row=table.first_row, rows=table.rows, truncated=table.truncated)
    )  # fmt: skip


def _describe(column: RawColumn, device: dict[str, str]) -> None:
    """What an acceleration means, and the sensor with its range."""
    column.kind = next((kind for pattern, kind in _KINDS if pattern.search(column.name)), "")
    if column.name.startswith("Absolute"):
        column.kind = ""  # a magnitude, the more so without a direction
    if re.search(r" [xyz]$", column.name):
        column.frame = "sensor"
    sensor = _SENSORS.get(column.name.split(" ")[0], "")
    column.sensor = device.get(f"{sensor} Name", "") if sensor else ""
    reach = _cell.number(device.get(f"{sensor} Range", "").replace(",", ".")) if sensor else None
    if reach is not None and reach > 0 and column.unit in ("m/s^2", "rad/s"):
        column.limits = (-reach, reach)


def _add_instants(log: RawLog, name: str, table: Table) -> None:
    """A stopwatch or (in)elastic collision: one row of instants becomes one sample for each."""
    if len(table) > 1:
        text = f"the table has {len(table)} rows; the last one, the final result, was taken"
        log.repairs.append(Repair("repeated_result", WARNING, text, name))
    last = {column.name: float(column.values[-1]) for column in table.columns}
    words = [n for n in last if _INSTANT.fullmatch(n)]
    times: list[float] = []
    for word in words:  # what has not happened is 0, or missing
        if not np.isfinite(last[word]) or (times and last[word] <= times[-1]):
            break
        times.append(last[word])
    missing = [word for word in words[len(times) :]]
    if missing:
        log.ignored |= {f"{name}/{word}": "did not happen (its time is 0)" for word in missing}
    columns = [RawColumn("time", np.array(times), "s")]
    for quantity, unit in (("Height", "m"), ("Energy", "1")):
        if any(column.startswith(quantity) for column in last):
            values = [last.get(f"{quantity} {i}", np.nan) for i in range(len(times))]
            columns.append(RawColumn(quantity.lower(), np.array(values), unit))
            text = f"{quantity.lower()} was worked out by the app from the intervals, not measured"
            log.repairs.append(Repair("derived", INFO, text, name, quantity.lower()))
    steps = np.diff(times, prepend=np.nan) if times else np.empty(0)
    columns.append(RawColumn("interval", steps, "s"))
    log.events += [Event(w.lower(), t, name) for w, t in zip(words, times, strict=False)]
    row = table.first_row + len(table) - 1 if table.rows is None else int(table.rows[-1])
    log.streams.append(
        RawStream(name, columns, "time", clock=Clock("experiment time"), row_word="line",
                  rows=np.full(len(times), row, dtype=np.int64), truncated=table.truncated)
    )  # fmt: skip


def _clocks(log: RawLog, source: _source.Source | None) -> None:
    """Start and pauses of the measurement."""
    if source is None:
        return
    separator = _separator(source)
    marks: list[tuple[str, float, float]] = []
    for line in source.head[1:]:
        cells = _cell.split(line, separator)
        if len(cells) > 2 and cells[0] in ("START", "PAUSE"):
            values = [_cell.number(cell.replace(",", ".")) for cell in cells[1:3]]
            if values[0] is not None and values[1] is not None:
                marks.append((cells[0], values[0], values[1]))
    starts = [mark for mark in marks if mark[0] == "START"]
    if not starts:
        return
    for stream in log.streams:
        stream.clock = Clock("experiment time", _instant(stream, starts))
    log.about["start"] = _iso(starts[0][2])
    _say_pauses(log, marks)


def _instant(stream: RawStream, starts: Sequence[tuple[str, float, float]]) -> str:
    """When the first sample was taken: experiment time counts from the first start."""
    first = stream.columns[0].values[:1]
    after = float(first[0]) - starts[0][1] if len(first) and np.isfinite(first[0]) else 0.0
    return _iso(starts[0][2] + after)


def _iso(seconds: float) -> str:
    start = datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)
    try:
        return (start + datetime.timedelta(seconds=seconds)).isoformat(timespec="milliseconds")
    except OverflowError:
        return ""


def _say_pauses(log: RawLog, marks: Sequence[tuple[str, float, float]]) -> None:
    for before, after in itertools.pairwise(marks):
        if (before[0], after[0]) == ("PAUSE", "START"):
            text = (
                f"the measurement was paused at {before[1]:g} s for {after[2] - before[2]:.3g} s;"
                " the time of the experiment leaves the pause out"
            )
            log.repairs.append(Repair("pause", WARNING, text))
