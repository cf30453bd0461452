"""A recording on disk: a folder with ``recording.json`` and one Parquet table for each stream.

A table has a column ``time_s``, one for each channel, and beside it ``u:<channel>`` or
``saturated:<channel>`` where these differ from sample to sample; recording.json names them, as two
of these names may be the same. What is missing is NULL.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from simcompare.errors import InputError, OutputError
from simcompare.model import parquet, record_file, whole
from simcompare.model.plain import text
from simcompare.model.recording import (
    Channel,
    Clock,
    Event,
    Provenance,
    Recording,
    Stream,
)
from simcompare.model.trajectory import Array

HEAD = "recording.json"
#: version of what recording.json holds, and the first one, which told no digests
FORMAT, _FIRST_FORMAT = 2, 1
#: the clock in every table
TIME = "time_s"
_TABLE = re.compile(r"stream-\d{3,}\.parquet")
#: names of the files that a stored recording is made of
_OURS = re.compile(rf"recording\.json|{_TABLE.pattern}")
_AGAIN = "import the log again"
_U, _SATURATED = "u:", "saturated:"
#: version 2 stores bytes of equal weight together, which packs measured numbers better and faster
#: than looking for repeated ones
_PACKED = ", parquet_version v2, dictionary_size_limit 1"


def save(recording: Recording, folder: Path) -> Path:
    """Writes a recording; an older recording in the same place is replaced.

    Raises:
        OutputError: it cannot be written, or the place holds something else.
    """
    try:
        place = folder.resolve()
        _check_place(folder, place)
        place.parent.mkdir(parents=True, exist_ok=True)
        with whole.folder(place) as partial:
            _write(recording, partial)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise OutputError(
            f"{folder}: the recording cannot be written ({reason});"
            " free some space or choose another -o"
        ) from None
    return folder


def _check_place(folder: Path, place: Path) -> None:
    """Only a recording is replaced, and only where nothing else would be lost with it."""
    if not place.exists():
        return
    if not is_recording(place) or not place.name:
        raise OutputError(f"{folder}: exists and is no recording; choose another -o")
    others = sorted(p.name for p in place.iterdir() if not _OURS.fullmatch(p.name))
    if others:
        shown = ", ".join(others[:5]) + (" …" if len(others) > 5 else "")
        raise OutputError(
            f"{folder}: holds other files beside the recording ({shown}), which would be lost with"
            " it; move them or choose another -o"
        )


@dataclass(frozen=True)
class _ChannelHead:
    """What recording.json says of a channel.

    Attributes:
        unit: and what follows: as the channel has it; ``u`` where it is one number.
        columns: "values", "u" and "saturated" -> column of the table; the first recordings that
            were stored do not name them.
    """

    unit: str
    frame: str
    u: float | None
    sensor: str
    kind: str
    raw: str
    columns: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class _StreamHead:
    """What recording.json says of a stream: its table, and what that does not hold.

    Attributes:
        sha256: digest of the table; the first format does not tell it.
    """

    table: str
    samples: int
    clock: Clock
    gaps: tuple[int, ...]
    channels: Mapping[str, _ChannelHead]
    sha256: str = ""


@dataclass(frozen=True)
class _Head:
    """What recording.json holds."""

    format: int
    provenance: Provenance
    events: tuple[Event, ...]
    streams: Mapping[str, _StreamHead]


def _write(recording: Recording, folder: Path) -> None:
    streams = {}
    # one for all: a log may have thousands of streams
    with parquet.connect() as connection:
        # each thread holds a group of rows of every column: one keeps a long log small
        connection.execute("set threads=1")
        for number, (name, stream) in enumerate(recording.streams.items(), start=1):
            head = _stream_head(stream, f"stream-{number:03}.parquet")
            written = _write_table(connection, folder / head.table, stream, head)
            streams[name] = replace(head, sha256=written.sha256)
    head_of_all = _Head(FORMAT, recording.provenance, recording.events, streams)
    (folder / HEAD).write_text(text(head_of_all, indent=1) + "\n", encoding="utf-8")


def is_recording(path: Path) -> bool:
    """Whether a folder holds a stored recording."""
    return (path / HEAD).is_file()


def load(folder: Path) -> Recording:
    """Reads a stored recording.

    Raises:
        InputError: there is none, or its files are damaged; names the file.
    """
    while True:
        path, before = folder / HEAD, _inode(folder)
        try:
            return _load(path)
        except InputError:
            if _inode(folder) == before:  # else it has just been replaced by a whole one
                raise


def _load(path: Path) -> Recording:
    content = record_file.read(path, _AGAIN)
    found = content.get("format") if isinstance(content, dict) else content
    if found not in (_FIRST_FORMAT, FORMAT) or isinstance(found, bool):
        fault = f"format {found!r} is not known; expected {FORMAT}"
        raise InputError(str(path), [f"{fault}; {_AGAIN}, or update simcompare"])
    head = record_file.record(_Head, content, path)
    _check_tables(path, head)
    streams = {name: _stream(path, name, one) for name, one in head.streams.items()}
    return Recording(streams, head.provenance, head.events)


def _inode(folder: Path) -> int:
    try:
        return folder.stat().st_ino
    except OSError:
        return 0


def _check_tables(path: Path, head: _Head) -> None:
    """Tables lie beside recording.json under the names that we give them, each of one stream."""
    tables = [one.table for one in head.streams.values()]
    faults = [
        f"streams.{name}.table: {one.table!r} is no name of a table; expected a name such as"
        f" stream-001.parquet; {_AGAIN}"
        for name, one in head.streams.items()
        if not _TABLE.fullmatch(one.table)
    ]
    faults += [
        f"streams.{name}.sha256: is missing; expected the digest of {one.table}; {_AGAIN}"
        for name, one in head.streams.items()
        if head.format > _FIRST_FORMAT and not one.sha256
    ]
    if len(set(tables)) < len(tables):
        faults.append(f"two streams have the same table; {_AGAIN}")
    if faults:
        raise InputError(str(path), faults)


def _column_names(stream: Stream) -> dict[str, dict[str, str]]:
    """Columns of each channel in its table; no two are alike, whatever channels are called."""
    taken = {TIME}
    names: dict[str, dict[str, str]] = {}
    for name, channel in stream.channels.items():
        wanted = {"values": name}
        if isinstance(channel.u, np.ndarray):
            wanted["u"] = _U + name
        if channel.saturated is not None:
            wanted["saturated"] = _SATURATED + name
        names[name] = {part: _free(text, taken) for part, text in wanted.items()}
    return names


def _free(wanted: str, taken: set[str]) -> str:
    """A name that is not taken yet; tables do not tell small letters from large ones."""
    name, number = wanted, 2
    while name.lower() in taken:
        name, number = f"{wanted} ({number})", number + 1
    taken.add(name.lower())
    return name


def _stream_head(stream: Stream, table: str) -> _StreamHead:
    columns = _column_names(stream)
    channels = {
        name: _ChannelHead(
            channel.unit, channel.frame, None if isinstance(channel.u, np.ndarray) else channel.u,
            channel.sensor, channel.kind, channel.raw, columns[name],
        )
        for name, channel in stream.channels.items()
    }  # fmt: skip
    gaps = tuple(int(i) for i in stream.gaps)
    return _StreamHead(table, len(stream.time_s), stream.clock, gaps, channels)


def _write_table(
    connection: parquet.Connection, path: Path, stream: Stream, head: _StreamHead
) -> parquet.Table:
    columns = {TIME: np.asarray(stream.time_s)}
    for name, channel in stream.channels.items():
        for part, column in head.channels[name].columns.items():
            columns[column] = np.asarray(getattr(channel, part))
    selected = ", ".join(parquet.register(connection, "samples", columns))
    written = parquet.write(connection, f"select {selected} from samples", path, _PACKED)
    connection.unregister("samples")
    return written


def _stream(path: Path, name: str, head: _StreamHead) -> Stream:
    """One stream with its table.

    Raises:
        InputError: they do not belong together.
    """
    table = path.with_name(head.table)
    columns = parquet.read(table, parquet.Table(head.sha256, head.samples), _AGAIN)
    try:
        channels = {one: _channel(one, about, columns) for one, about in head.channels.items()}
        stream = Stream(_numbers(TIME, columns), channels, head.clock, head.gaps)
    except ValueError as error:
        raise InputError(
            str(table), [f"is not what {HEAD} says of it: {error}; {_AGAIN}"]
        ) from None
    if any(not 0 <= i < head.samples for i in head.gaps):
        fault = f"streams.{name}.gaps: expected numbers of samples, from 0 to {head.samples - 1}"
        raise InputError(str(path), [f"{fault}; {_AGAIN}"])
    return stream


def _channel(name: str, head: _ChannelHead, columns: parquet.Columns) -> Channel:
    names = head.columns or {"values": name, "u": _U + name, "saturated": _SATURATED + name}
    u, saturated = names.get("u", ""), names.get("saturated", "")
    return Channel(
        _numbers(names.get("values", name), columns), head.unit, head.frame,
        _numbers(u, columns) if u in columns else head.u, head.sensor, head.kind, head.raw,
        columns.get(saturated),
    )  # fmt: skip


def _numbers(name: str, columns: parquet.Columns) -> Array:
    """A column of the table.

    Raises:
        ValueError: there is none, or it holds something else than numbers.
    """
    if name not in columns:
        raise ValueError(f"there is no column {name!r}")
    if columns[name].dtype != np.float64:
        raise ValueError(f"its column {name!r} holds no numbers")
    return columns[name]
