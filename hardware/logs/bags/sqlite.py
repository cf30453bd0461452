"""The SQLite storage of ROS 2 bags (``.db3``)."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from pathlib import Path

from simcompare.errors import InputError
from simcompare.hardware.logs.bags.container import Connection, Message, State

MAGIC = b"SQLite format 3\0"
_LANGUAGES = {"ros2msg": "msg", "ros2idl": "idl"}


def messages(path: Path, state: State) -> Iterator[Message]:
    """All messages of one SQLite file, in the order in which they were written.

    Raises:
        InputError: it has no tables of a bag, or is truncated.
    """
    _check_length(path)
    if path.with_name(f"{path.name}-wal").is_file():
        state.truncated = f"{path.name}-wal lies beside it and was not merged: open it with sqlite3"
    place = f"{path.resolve().as_uri()}?mode=ro&immutable=1"
    base = sqlite3.connect(place, uri=True)
    try:
        known = _connections(base, path)
        state.connections.update(dict.fromkeys(known.values()))
        yield from _rows(base, known, state)
    finally:
        base.close()


def _check_length(path: Path) -> None:
    """SQLite would read zeros where a file was cut off, so such a file is refused."""
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(100)
    page = int.from_bytes(head[16:18], "big")
    wanted = (65536 if page == 1 else page) * int.from_bytes(head[28:32], "big")
    is_stated = head[24:28] == head[92:96]  # otherwise an old writer left the length as it was
    if len(head) < 100 or (is_stated and wanted > size):
        raise InputError(
            str(path),
            [
                f"byte {size}: the file is truncated, {wanted - size} of {wanted} bytes are missing"
                " and cannot be told from zeros; copy it again or try `sqlite3 FILE .recover`"
            ],
        )


def _connections(base: sqlite3.Connection, path: Path) -> dict[int, Connection]:
    schemas: dict[str, tuple[str, str]] = {}
    try:
        names = {row[0] for row in base.execute("SELECT name FROM sqlite_master")}
        if not {"topics", "messages"} <= names:
            raise InputError(
                str(path), [f"has no tables 'topics' and 'messages' (has {sorted(names)[:9]})"]
            )
        if "message_definitions" in names:
            rows = base.execute(
                "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
            )
            schemas = {str(k): (_LANGUAGES.get(str(e), str(e)), str(t)) for k, e, t in rows}
        topics = base.execute("SELECT id, name, type, serialization_format FROM topics")
        return {
            int(number): Connection(
                str(topic), str(kind), str(form), *reversed(schemas.get(str(kind), ("", "")))
            )
            for number, topic, kind, form in topics
        }
    except (sqlite3.Error, ValueError, TypeError) as error:
        raise InputError(
            str(path), [f"is a damaged SQLite bag: {error}; try `sqlite3 FILE .recover`"]
        ) from None


def _rows(
    base: sqlite3.Connection, known: dict[int, Connection], state: State
) -> Iterator[Message]:
    last = 0
    try:
        for number, topic, time, data in base.execute(
            "SELECT id, topic_id, timestamp, data FROM messages ORDER BY id"
        ):
            if topic not in known or not isinstance(data, bytes) or not isinstance(time, int):
                state.damaged.append(f"message {number} belongs to no topic; it was left out")
                continue
            last = number
            yield known[topic], time, data
    except sqlite3.Error as error:
        state.truncated = f"the data base is damaged behind message {last} ({error})"
