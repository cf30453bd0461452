"""A recording on its way from the process that read it: JSON, and a file of plain numbers."""

from __future__ import annotations

from pathlib import Path
from typing import IO, Any

import numpy as np

from simcompare.model import plain
from simcompare.model.recording import Channel, Clock, Event, Provenance, Recording, Stream

_FILE = "numbers"
#: numbers of an array that are taken into memory; more are looked at where they lie
_HELD = 1 << 22
_KINDS = ("float64", "float32", "int64", "bool")


def take_apart(recording: Recording, folder: Path) -> plain.Plain:
    """What JSON holds of a recording; its numbers are written into a file of the folder."""
    with (folder / _FILE).open("wb") as file:
        streams = {name: _stream_apart(one, file) for name, one in recording.streams.items()}
    return {
        "streams": streams,
        "events": [plain.plain(event) for event in recording.events],
        "provenance": plain.plain(recording.provenance),
    }


def _stream_apart(stream: Stream, file: IO[bytes]) -> plain.Plain:
    return {
        "time_s": _laid_down(stream.time_s, file),
        "channels": {
            name: {key: _laid_down(value, file) for key, value in vars(channel).items()}
            for name, channel in stream.channels.items()
        },
        "clock": plain.plain(stream.clock),
        "gaps": [int(gap) for gap in stream.gaps],
    }


def _laid_down(value: Any, file: IO[bytes]) -> Any:  # noqa: ANN401
    """What JSON holds, or where an array is: its kind, how many, and the first byte."""
    if isinstance(value, np.generic):
        return value.item()
    if not isinstance(value, np.ndarray):
        return value
    start = file.tell()
    np.ascontiguousarray(value).tofile(file)
    return [value.dtype.name, len(value), start]


def put_together(content: plain.Plain, folder: Path) -> Recording:
    """The recording that was taken apart."""
    streams = {
        name: Stream(
            _array(one["time_s"], folder / _FILE),
            {key: _channel(channel, folder / _FILE) for key, channel in one["channels"].items()},
            plain.of_plain(Clock, one["clock"]),
            tuple(one["gaps"]),
        )
        for name, one in content["streams"].items()
    }
    events = plain.of_plain(tuple[Event, ...], content["events"])
    return Recording(streams, plain.of_plain(Provenance, content["provenance"]), events)


def _channel(content: plain.Plain, file: Path) -> Channel:
    return Channel(**{k: _array(v, file) if isinstance(v, list) else v for k, v in content.items()})


def _array(told: list[Any], file: Path) -> Any:  # noqa: ANN401
    kind, count, start = told
    if kind not in _KINDS:
        raise ValueError(f"{kind}: no kind of number that a recording holds")
    if count <= _HELD:
        return np.fromfile(file, kind, count, offset=start)
    return np.memmap(file, kind, "r", offset=start, shape=(count,))
