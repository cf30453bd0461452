"""A recording on disk: a folder with ``recording.json`` and one Parquet table for each stream.

A table has a column ``time_s``, one for each channel, and beside it ``u:<channel>`` or
``saturated:<channel>`` where these differ from sample to sample; recording.json names them, as two
of these names may be the same. What is missing is NULL.
"""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import InputError, OutputError
from simcompare.model import parquet
from simcompare.model.plain import of_plain, text
from simcompare.model.recording import (
    Channel,
    Clock,
    Event,
    Provenance,
    Recording,
    Stream,
)

HEAD = "recording.json"
#: version of what recording.json holds
FORMAT = 1
#: the clock in every table
TIME = "time_s"
#: names of the files that a stored recording is made of
_OURS = re.compile(r"recording\.json|stream-\d{3,}\.parquet")
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
        partial = place.with_name(f".{place.name}.partial")
        try:
            shutil.rmtree(partial, ignore_errors=True)
            partial.mkdir(parents=True)
            _write(recording, partial)
            _put(partial, place)
        finally:
            shutil.rmtree(partial, ignore_errors=True)
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
    """What recording.json says of a stream: its table, and what that does not hold."""

    table: str
    samples: int
    clock: Clock
    gaps: tuple[int, ...]
    channels: Mapping[str, _ChannelHead]


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
            _write_table(connection, folder / head.table, stream, head)
            streams[name] = head
    whole = _Head(FORMAT, recording.provenance, recording.events, streams)
    (folder / HEAD).write_text(text(whole, indent=1) + "\n", encoding="utf-8")


def _put(made: Path, place: Path) -> None:
    """Puts a new recording where perhaps an old one is, which is lost only afterwards."""
    old = place.with_name(f".{place.name}.old")
    if place.exists():
        shutil.rmtree(old, ignore_errors=True)
        place.rename(old)
    try:
        made.rename(place)
    except OSError:
        if old.exists():
            old.rename(place)
        raise
    shutil.rmtree(old, ignore_errors=True)


def is_recording(path: Path) -> bool:
    """Whether a folder holds a stored recording."""
    return (path / HEAD).is_file()


def load(folder: Path) -> Recording:
    """Reads a stored recording.

    Raises:
        InputError: there is none, or its files are damaged; names the file.
    """
    path = folder / HEAD
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise InputError(
                str(path), [f"format {content['format']!r} is not known; expected {FORMAT}"]
            )
        head = of_plain(_Head, content)
        streams = {
            name: _stream(one, parquet.read(folder / one.table, "import the log again"))
            for name, one in head.streams.items()
        }
        return Recording(streams, head.provenance, head.events)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(
            str(path), [f"cannot be read ({type(error).__name__}: {error}); import the log again"]
        ) from None


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
) -> None:
    columns = {TIME: np.asarray(stream.time_s)}
    for name, channel in stream.channels.items():
        for part, column in head.channels[name].columns.items():
            columns[column] = np.asarray(getattr(channel, part))
    selected = ", ".join(parquet.register(connection, "samples", columns))
    parquet.copy(connection, f"select {selected} from samples", path, _PACKED)
    connection.unregister("samples")


def _stream(head: _StreamHead, columns: Mapping[str, Any]) -> Stream:
    channels = {}
    for name, about in head.channels.items():
        names = about.columns or {"values": name, "u": _U + name, "saturated": _SATURATED + name}
        channels[name] = Channel(
            columns[names["values"]], about.unit, about.frame,
            columns.get(names.get("u", ""), about.u), about.sensor, about.kind, about.raw,
            columns.get(names.get("saturated", "")),
        )  # fmt: skip
    return Stream(columns[TIME], channels, head.clock, head.gaps)
