"""A recording on disk: a folder with ``recording.json`` and one Parquet table for each stream.

A table has a column ``time_s``, one for each channel, and beside it ``u:<channel>`` or
``saturated:<channel>`` where these differ from sample to sample. What is missing is NULL.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import InputError, OutputError
from simcompare.recording import (
    Channel,
    Clock,
    Conversion,
    Event,
    Provenance,
    Recording,
    Repair,
    Stream,
)
from simcompare.trajectory import Array

HEAD = "recording.json"
#: version of what recording.json holds
FORMAT = 1
_U, _SATURATED = "u:", "saturated:"
#: version 2 stores bytes of equal weight together, which packs measured numbers better and faster
#: than looking for repeated ones
_PARQUET = "format parquet, parquet_version v2, compression zstd, dictionary_size_limit 1"


def save(recording: Recording, folder: Path) -> Path:
    """Writes a recording; an older recording in the same place is replaced.

    Raises:
        OutputError: it cannot be written, or the place holds something else.
    """
    partial = folder.with_name(f".{folder.name}.partial")
    if folder.exists() and not (folder / HEAD).is_file():
        raise OutputError(f"{folder}: exists and is no recording; choose another -o")
    try:
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir(parents=True)
        streams = {}
        for number, (name, stream) in enumerate(recording.streams.items(), start=1):
            table = f"stream-{number:03}.parquet"
            _write_table(partial / table, stream)
            streams[name] = {"table": table, **_stream_head(stream)}
        text = json.dumps(_head(recording, streams), indent=1, ensure_ascii=False, allow_nan=False)
        (partial / HEAD).write_text(text + "\n", encoding="utf-8")
        shutil.rmtree(folder, ignore_errors=True)
        partial.rename(folder)
    except OSError as error:
        raise OutputError(
            f"{folder}: the recording cannot be written ({error.strerror or error});"
            " free some space or choose another -o"
        ) from None
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return folder


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
            name: _stream(one, _read_table(folder / one["table"]))
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


def _stream_head(stream: Stream) -> dict[str, Any]:
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
        }
    return {
        "samples": len(stream.time_s),
        "clock": asdict(stream.clock),
        "gaps": [int(i) for i in stream.gaps],
        "channels": channels,
    }


def _write_table(path: Path, stream: Stream) -> None:
    import duckdb

    columns: dict[str, Any] = {"time_s": np.asarray(stream.time_s)}
    for name, channel in stream.channels.items():
        columns[name] = np.asarray(channel.values)
        if isinstance(channel.u, np.ndarray):
            columns[_U + name] = np.asarray(channel.u)
        if channel.saturated is not None:
            columns[_SATURATED + name] = channel.saturated
    # numbered in the query: names of channels may hold anything
    numbered = {f"c{i}": values for i, values in enumerate(columns.values())}
    chosen = ", ".join(
        (f"nullif(c{i}, 'nan'::double)" if values.dtype == np.float64 else f"c{i}")
        + ' as "{}"'.format(name.replace('"', '""'))
        for i, (name, values) in enumerate(columns.items())
    )
    try:
        with duckdb.connect() as connection:
            # each thread holds a group of rows of every column: one keeps a long log small
            connection.execute("set threads=1")
            connection.register("samples", numbered)
            connection.execute(
                f"copy (select {chosen} from samples) to '{_quoted(path)}' ({_PARQUET})"
            )
    except duckdb.Error as error:
        message = str(error).splitlines()[0].partition(": {")[0]
        raise OSError(f"writing {path.name}: {message}") from None


def _read_table(path: Path) -> dict[str, Any]:
    import duckdb

    try:
        with duckdb.connect() as connection:
            columns = connection.execute(f"select * from '{_quoted(path)}'").fetchnumpy()
    except duckdb.Error as error:
        raise InputError(str(path), [f"cannot be read: {str(error).splitlines()[0]}"]) from None
    return {
        name: np.ma.filled(values, np.nan) if values.dtype == np.float64 else np.ma.filled(values)
        for name, values in columns.items()
    }


def _stream(head: Mapping[str, Any], columns: Mapping[str, Array]) -> Stream:
    channels = {}
    for name, about in head["channels"].items():
        u = columns.get(_U + name, about["u"])
        saturated: Any = columns.get(_SATURATED + name)
        channels[name] = Channel(
            columns[name], about["unit"], about["frame"], u, about["sensor"], about["kind"],
            about["raw"], saturated,
        )  # fmt: skip
    return Stream(columns["time_s"], channels, Clock(**head["clock"]), tuple(head["gaps"]))


def _provenance(head: Mapping[str, Any]) -> Provenance:
    conversions = tuple(Conversion(**row) for row in head["conversions"])
    repairs = tuple(
        Repair(**{**row, "rows": tuple((first, last) for first, last in row["rows"])})
        for row in head["repairs"]
    )
    return Provenance(**{**head, "conversions": conversions, "repairs": repairs})


def _events(rows: list[Mapping[str, Any]]) -> tuple[Event, ...]:
    return tuple(Event(**row) for row in rows)


def _quoted(path: Path) -> str:
    return str(path).replace("'", "''")
