"""ROS 1 bags (format 2.0): records of named fields, most of them in chunks."""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from pathlib import Path

from simcompare.errors import InputError
from simcompare.hardware.logs.bags.container import Connection, Cut, Message, Source, State, unpack

MAGIC = b"#ROSBAG"
_START = MAGIC + b" V2.0\n"
_MESSAGE, _BAG, _INDEX, _CHUNK, _CHUNK_INFO, _CONNECTION = 2, 3, 4, 5, 6, 7
_U32 = struct.Struct("<I")
_TIME = struct.Struct("<II")
#: no header of a record is longer; only a connection's holds text
_MAX_HEADER = 1 << 20

Known = dict[int, Connection]


def messages(path: Path, state: State) -> Iterator[Message]:
    """All messages of a bag, in the order in which they were written.

    Raises:
        InputError: it is of another version, or encrypted.
    """
    with path.open("rb") as file:
        source = Source(file, path.stat().st_size)
        start = file.readline(32)
        if start != _START:
            text = start.decode("ascii", "replace").strip()
            raise InputError(
                str(path),
                [f"begins with {text!r}; expected '#ROSBAG V2.0' (convert it with rosbag fix)"],
            )
        source.at = len(start)
        try:
            head = _fields(source)[0]
        except Cut as cut:
            raise InputError(str(path), [f"has no whole bag header: {cut}"]) from None
        _check(path, head, state)
        yield from _records(source, state, {}, _chunk_count(head))


def _chunk_count(head: dict[str, bytes]) -> int:
    """Number of chunks that a closed bag has, -1 for one that was not closed."""
    if int.from_bytes(head.get("index_pos", b""), "little") == 0:
        return -1
    return int.from_bytes(head.get("chunk_count", b""), "little")


def _check(path: Path, head: dict[str, bytes], state: State) -> None:
    if head.get("op", b"")[:1] != bytes([_BAG]):
        raise InputError(str(path), ["byte 13: the first record is no bag header"])
    if head.get("encryptor"):
        raise InputError(str(path), ["is encrypted; decrypt it with the rosbag tools first"])
    if _chunk_count(head) < 0:
        state.truncated = "the bag was never closed (it has no index); its last messages may miss"


def _records(source: Source, state: State, known: Known, chunks: int) -> Iterator[Message]:
    """Records of the file itself; ``chunks`` are expected."""
    count = 0
    while source.rest:
        place = source.place
        try:
            head, size = _fields(source, body=True)
            operation = head["op"][0] if head.get("op") else 0
            if operation == _CHUNK:
                count += 1
                yield from _chunk(source, head, size, state, known, place)
            elif operation in (_MESSAGE, _CONNECTION):
                # a recorder that was killed leaves its last chunk open
                yield from _one(source, head, size, operation, state, known)
            elif operation in (_INDEX, _CHUNK_INFO, _BAG):
                source.take(size, "a record of the index")
            else:
                raise Cut(f"the record at {place} is of the unknown kind {operation}")
        except Cut as cut:
            state.truncated = f"{cut}; what follows cannot be read"
            return
    if count < chunks:
        state.truncated = f"{source.place}: the bag ends after {count} of {chunks} chunks"


def _chunk(
    source: Source, head: dict[str, bytes], size: int, state: State, known: Known, place: str
) -> Iterator[Message]:
    kind = head.get("compression", b"").decode("ascii", "replace")
    size_unpacked = int.from_bytes(head.get("size", b""), "little")
    if size > source.rest and kind == "none":
        # the messages at its beginning are whole
        data = source.take(source.rest, "the chunk")
        yield from _inside(data, place, state, known)
        raise Cut(f"the chunk at {place} should have {size} bytes; {len(data)} are there")
    packed = source.take(size, "the chunk")
    try:
        data = unpack(kind, packed, size_unpacked)
    except Cut as cut:
        state.damaged.append(f"the chunk at {place} {cut}; it was left out")
        return
    try:
        yield from _inside(data, place, state, known)
    except Cut as cut:
        state.damaged.append(f"in the chunk at {place}: {cut}; the rest of it was left out")


def _inside(data: bytes, place: str, state: State, known: Known) -> Iterator[Message]:
    """Messages and connections of a chunk."""
    inner = Source(io.BytesIO(data), len(data))
    view = _View(data)
    while inner.rest:
        message = view.message(inner.at)
        if message is not None and message[0] in known:
            number, time, start, end = message
            yield known[number], time, data[start:end]
            inner.skip(end)
            continue
        head, size = _fields(inner, body=True)
        operation = head["op"][0] if head.get("op") else 0
        if operation not in (_MESSAGE, _CONNECTION):
            raise Cut(f"a record of the unknown kind {operation} at {inner.place} of it")
        yield from _one(inner, head, size, operation, state, known)


class _View:
    """A chunk in which the headers of messages are read without taking them apart.

    A writer gives all its messages headers with the same fields in the same order. So the places
    of their values are found once; they hold as long as the names of the fields stand before them.
    """

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._places: tuple[int, int, int, int] | None = None

    def message(self, at: int) -> tuple[int, int, int, int] | None:
        """Connection, time [ns], begin and end of the message at ``at``, where it is one."""
        data, places = self._data, self._places or self._learn(at)
        if places is None:
            return None
        size, operation, connection, time = places
        operation, connection, time = at + operation, at + connection, at + time
        start = at + size + 8
        if (
            start > len(data)
            or data[at : at + 4] != _U32.pack(size)
            or data[operation - 7 : operation + 1] != b"\4\0\0\0op=\2"
            or data[connection - 9 : connection] != b"\x09\0\0\0conn="
            or data[time - 9 : time] != b"\x0d\0\0\0time="
        ):
            return None
        end = start + int(_U32.unpack_from(data, start - 4)[0])
        if end > len(data):
            return None
        seconds, nanoseconds = _TIME.unpack_from(data, time)
        number = int(_U32.unpack_from(data, connection)[0])
        return number, seconds * 1_000_000_000 + nanoseconds, start, end

    def _learn(self, at: int) -> tuple[int, int, int, int] | None:
        size = int.from_bytes(self._data[at : at + 4], "little")
        head = self._data[at : at + 4 + min(size, 256)]
        places = [head.find(name) for name in (b"op=\2", b"conn=", b"time=")]
        if min(places) < 0:
            return None
        self._places = (size, places[0] + 3, places[1] + 5, places[2] + 5)
        return self._places


def _one(
    source: Source, head: dict[str, bytes], size: int, operation: int, state: State, known: Known
) -> Iterator[Message]:
    place = source.place
    body = source.take(size, "the message")
    number = int.from_bytes(head.get("conn", b"\xff" * 5), "little")
    if operation == _CONNECTION:
        known[number] = _connection(head, body)
        state.connections[known[number]] = None
        return
    if number not in known or len(head.get("time", b"")) != 8:
        raise Cut(f"the message at {place} belongs to no known topic")
    seconds, nanoseconds = _TIME.unpack(head["time"])
    yield known[number], seconds * 1_000_000_000 + nanoseconds, body


def _connection(head: dict[str, bytes], body: bytes) -> Connection:
    fields = _pairs(body)
    topic = head.get("topic", b"").decode("utf-8", "replace")
    kind = fields.get("type", b"").decode("utf-8", "replace")
    package, _, name = kind.partition("/")
    schema = fields.get("message_definition", b"").decode("utf-8", "replace")
    caller = fields.get("callerid", b"").decode("utf-8", "replace")
    return Connection(topic, f"{package}/msg/{name}", "ros1", schema, "msg", caller)


def _fields(source: Source, body: bool = False) -> tuple[dict[str, bytes], int]:
    """Header of the next record and the length of its body (taken where not ``body``)."""
    place = source.place
    size = _U32.unpack(source.take(4, "the record"))[0]
    if size > _MAX_HEADER:
        raise Cut(f"the record at {place} says that its header has {size} bytes")
    fields = _pairs(source.take(size, "the header of the record"), place)
    length = _U32.unpack(source.take(4, "the record"))[0]
    if not body:
        source.take(length, "the bag header")
    return fields, length


def _pairs(data: bytes, place: str = "its beginning") -> dict[str, bytes]:
    """``name=value`` fields, each behind its length."""
    fields: dict[str, bytes] = {}
    at = 0
    while at < len(data):
        if at + 4 > len(data):
            raise Cut(f"the header of the record at {place} is damaged")
        size = _U32.unpack_from(data, at)[0]
        name, equals, value = data[at + 4 : at + 4 + size].partition(b"=")
        at += 4 + size
        if not equals or at > len(data):
            raise Cut(f"the header of the record at {place} is damaged")
        fields[name.decode("ascii", "replace")] = value
    return fields
