"""A recording on disk: a folder with ``recording.json`` and one Parquet table for each stream.

A table has a column ``time_s``, one for each channel, and beside it ``u:<channel>`` or
``saturated:<channel>`` where these differ from sample to sample; recording.json names them, as two
of these names may be the same. What is missing is NULL.
"""

from __future__ import annotations

import json
import math
import re
import shutil
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import InputError, OutputError
from simcompare.model import parquet
from simcompare.model.recording import (
    Channel,
    Clock,
    Conversion,
    Event,
    Provenance,
    Recording,
    Repair,
    Stream,
)
from simcompare.model.trajectory import Array

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


def _write(recording: Recording, folder: Path) -> None:
    streams = {}
    # one for all: a log may have thousands of streams
    with parquet.connect() as connection:
        # each thread holds a group of rows of every column: one keeps a long log small
        connection.execute("set threads=1")
        for number, (name, stream) in enumerate(recording.streams.items(), start=1):
            table = f"stream-{number:03}.parquet"
            names = _column_names(stream)
            _write_table(connection, folder / table, stream, names)
            streams[name] = {"table": table, **_stream_head(stream, names)}
    head = plain(_head(recording, streams))
    text = json.dumps(head, indent=1, ensure_ascii=False, allow_nan=False)
    (folder / HEAD).write_text(text + "\n", encoding="utf-8")


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


def plain(value: Any) -> Any:  # noqa: ANN401  (whatever JSON may hold)
    """The same without numbers that JSON does not have: they become null."""
    if isinstance(value, Mapping):
        return {key: plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


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
        head = json.loads(path.read_text(encoding="utf-8"))
        if head["format"] != FORMAT:
            raise InputError(
                str(path), [f"format {head['format']!r} is not known; expected {FORMAT}"]
            )
        streams = {
            name: _stream(one, parquet.read(folder / one["table"]))
            for name, one in head["streams"].items()
        }
        return Recording(streams, _provenance(head["provenance"]), _events(head["events"]))
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            str(path), [f"cannot be read ({type(error).__name__}: {error}); import the log again"]
        ) from None


def _head(recording: Recording, streams: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "provenance": asdict(recording.provenance),
        "events": [asdict(event) for event in recording.events],
        "streams": streams,
    }


def _column_names(stream: Stream) -> dict[str, dict[str, str]]:
    """Columns of each channel in its table; no two are alike, whatever channels are called."""
    taken = {TIME}
    found: dict[str, dict[str, str]] = {}
    for name, channel in stream.channels.items():
        wanted = {"values": name}
        if isinstance(channel.u, np.ndarray):
            wanted["u"] = _U + name
        if channel.saturated is not None:
            wanted["saturated"] = _SATURATED + name
        found[name] = {what: _free(text, taken) for what, text in wanted.items()}
    return found


def _free(wanted: str, taken: set[str]) -> str:
    """A name that is not taken yet; tables do not tell small letters from large ones."""
    name, number = wanted, 2
    while name.lower() in taken:
        name, number = f"{wanted} ({number})", number + 1
    taken.add(name.lower())
    return name


def _stream_head(stream: Stream, names: Mapping[str, Mapping[str, str]]) -> dict[str, Any]:
    channels = {}
    for name, channel in stream.channels.items():
        u = None if isinstance(channel.u, np.ndarray) else channel.u
        channels[name] = {
            "unit": channel.unit,
            "frame": channel.frame,
            "u": u,
            "sensor": channel.sensor,
            "kind": channel.kind,
            "raw": channel.raw,
            "columns": dict(names[name]),
        }
    return {
        "samples": len(stream.time_s),
        "clock": asdict(stream.clock),
        "gaps": [int(i) for i in stream.gaps],
        "channels": channels,
    }


def _write_table(
    connection: parquet.Connection,
    path: Path,
    stream: Stream,
    names: Mapping[str, Mapping[str, str]],
) -> None:
    columns = {TIME: np.asarray(stream.time_s)}
    for name, channel in stream.channels.items():
        for what, column in names[name].items():
            columns[column] = np.asarray(getattr(channel, what))
    selected = ", ".join(parquet.register(connection, "samples", columns))
    parquet.copy(connection, f"select {selected} from samples", path, _PACKED)
    connection.unregister("samples")


def _stream(head: Mapping[str, Any], columns: Mapping[str, Array]) -> Stream:
    channels = {}
    for name, about in head["channels"].items():
        # the first recordings that were stored do not name their columns
        names = about.get("columns") or {
            "values": name,
            "u": _U + name,
            "saturated": _SATURATED + name,
        }
        u = columns.get(names.get("u", ""), about["u"])
        saturated: Any = columns.get(names.get("saturated", ""))
        channels[name] = Channel(
            columns[names["values"]], about["unit"], about["frame"], u, about["sensor"],
            about["kind"], about["raw"], saturated,
        )  # fmt: skip
    return Stream(columns[TIME], channels, Clock(**head["clock"]), tuple(head["gaps"]))


def _provenance(head: Mapping[str, Any]) -> Provenance:
    conversions = tuple(Conversion(**row) for row in head["conversions"])
    repairs = tuple(
        Repair(
            **{
                **row,
                "rows": tuple((first, last) for first, last in row["rows"]),
                "before": _numbers(row["before"]),
                "after": _numbers(row["after"]),
            }
        )
        for row in head["repairs"]
    )
    return Provenance(**{**head, "conversions": conversions, "repairs": repairs})


def _numbers(row: Mapping[str, float | None]) -> dict[str, float]:
    """Numbers of a repair; null stands for one that is not finite."""
    return {name: math.nan if value is None else value for name, value in row.items()}


def _events(rows: list[Mapping[str, Any]]) -> tuple[Event, ...]:
    return tuple(Event(**row) for row in rows)
