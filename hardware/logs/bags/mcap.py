"""MCAP files: records with a kind and a length, most of them in chunks with a check sum."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Generator, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from simcompare.hardware.logs.bags.container import Connection, Cut, Message, Source, State, unpack

MAGIC = b"\x89MCAP0\r\n"
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 1, 2, 3, 4, 5, 6, 15
_RECORD = struct.Struct("<BQ")
_MESSAGE_HEAD = struct.Struct("<HIQQ")
_CHUNK_HEAD = struct.Struct("<QQQI")
_LANGUAGES = {"ros1msg": "msg", "ros2msg": "msg", "ros2idl": "idl", "omgidl": "idl"}


@dataclass
class _Known:
    schemas: dict[int, tuple[str, str, str]] = field(default_factory=dict)
    channels: dict[int, Connection] = field(default_factory=dict)


def messages(path: Path, state: State) -> Iterator[Message]:
    """All messages of a file, in the order in which they were written."""
    with path.open("rb") as file:
        source = Source(file, path.stat().st_size)
        source.take(len(MAGIC), "the start")
        known = _Known()
        while True:
            try:
                end = yield from _record(source, known, state)
            except Cut as cut:
                state.truncated = f"{cut}; the file was not closed"
                return
            if end:
                return


def _record(source: Source, known: _Known, state: State) -> Generator[Message, None, bool]:
    """One record of the file itself; returns whether the data end with it."""
    place = source.place
    kind, size = _RECORD.unpack(source.take(_RECORD.size, "the next record"))
    if kind in (_DATA_END, _FOOTER):
        return True
    if kind == _CHUNK:
        yield from _chunk(source, size, known, state, place)
        return False
    body = source.take(size, f"the record (kind {kind})")
    if kind == _HEADER:
        fields = _Fields(body, place)
        state.about["profile"], state.about["library"] = fields.text(), fields.text()
    else:
        yield from _inner(kind, body, known, state, place)
    return False


def _chunk(source: Source, size: int, known: _Known, state: State, place: str) -> Iterator[Message]:
    cut_short = size > source.rest
    body = source.take(min(size, source.rest), "a chunk")
    fields = _Fields(body, place)
    _, _, size_unpacked, checksum = _CHUNK_HEAD.unpack(fields.take(_CHUNK_HEAD.size))
    compression = fields.text()
    packed = fields.rest(fields.number(8))
    if cut_short and compression:
        raise Cut(f"the chunk at {place} should have {size} bytes; {len(body)} are there")
    try:
        data = packed if cut_short else unpack(compression, packed, size_unpacked)
        if not cut_short and checksum and zlib.crc32(data) != checksum:
            state.damaged.append(
                f"the chunk at {place} does not fit its check sum; it was left out"
            )
            return
    except Cut as cut:
        state.damaged.append(f"the chunk at {place} {cut}; it was left out")
        return
    inner = Source(io.BytesIO(data), len(data))
    try:
        while inner.rest:
            kind, length = _RECORD.unpack(inner.take(_RECORD.size, "the next record"))
            yield from _inner(kind, inner.take(length, "the record"), known, state, place)
    except Cut as cut:
        if not cut_short:
            state.damaged.append(f"in the chunk at {place}: {cut}; the rest of it was left out")
    if cut_short:
        raise Cut(f"the chunk at {place} should have {size} bytes; {len(body)} are there")


def _inner(kind: int, body: bytes, known: _Known, state: State, place: str) -> Iterator[Message]:
    """Schema, channel or message; whatever else there is (indexes, attachments) is passed over."""
    if kind == _MESSAGE:
        if len(body) < _MESSAGE_HEAD.size:
            raise Cut(f"a message at {place} is too short")
        number, _, log_time, _ = _MESSAGE_HEAD.unpack_from(body)
        if number not in known.channels or log_time >> 63:
            raise Cut(f"a message at {place} belongs to no known channel or time")
        yield known.channels[number], log_time, body[_MESSAGE_HEAD.size :]
    elif kind == _SCHEMA:
        fields = _Fields(body, place)
        number, name, encoding = fields.number(2), fields.text(), fields.text()
        text = fields.rest(fields.number(4)).decode("utf-8", "replace")
        known.schemas[number] = (name, _LANGUAGES.get(encoding, encoding), text)
    elif kind == _CHANNEL:
        fields = _Fields(body, place)
        number, schema, topic, encoding = (
            fields.number(2), fields.number(2), fields.text(), fields.text()
        )  # fmt: skip
        name, language, text = known.schemas.get(schema, ("", "", ""))
        if encoding == "ros1" and name.count("/") == 1:
            name = name.replace("/", "/msg/")
        known.channels[number] = Connection(topic, name, encoding, text, language)
        state.connections[known.channels[number]] = None


class _Fields:
    """Numbers and texts of a record, one after the other."""

    def __init__(self, data: bytes, place: str) -> None:
        self._data, self._at, self._place = data, 0, place

    def take(self, count: int) -> bytes:
        if self._at + count > len(self._data):
            raise Cut(f"the record at {self._place} is damaged")
        self._at += count
        return self._data[self._at - count : self._at]

    def rest(self, most: int) -> bytes:
        return self.take(min(most, len(self._data) - self._at))

    def number(self, width: int) -> int:
        return int.from_bytes(self.take(width), "little")

    def text(self) -> str:
        return self.take(self.number(4)).decode("utf-8", "replace")
