"""ROS 2 bags: a folder with ``metadata.yaml`` and one or more files, and their SQLite storage."""

from __future__ import annotations

import re
import sqlite3
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import Any

import yaml

from simcompare.errors import InputError
from simcompare.hardware.logs.bags.files import (
    LEAST_LIMIT,
    MOST_TIMES,
    Connection,
    Message,
    State,
    reader_of,
    zstandard,
)

_LANGUAGES = {"ros2msg": "msg", "ros2idl": "idl"}
_BLOCK = 1 << 20
#: bytes of a description: parsing YAML is slow
_LONGEST = 1 << 22


def messages(path: Path, state: State) -> Iterator[Message]:
    """All messages of all files of a folder.

    Raises:
        InputError: it is no bag, files are missing, or it is of a version that is not known.
    """
    head = _metadata(path)
    files = _files(path, head, state)
    mode = str(head.get("compression_mode") or "").lower()
    counted: Counter[str] = Counter()
    for file in files:
        source = _unpacked(file) if mode == "file" or file.suffix == ".zstd" else file
        inner = State()
        try:
            for connection, time, data in reader_of(source)(source, inner):
                counted[connection.topic] += 1
                yield connection, time, _message(data, file) if mode == "message" else data
        finally:
            if source is not file:
                source.unlink()
        state.connections.update(inner.connections)
        state.damaged += [f"{file.name}: {text}" for text in inner.damaged]
        if inner.truncated:
            state.truncated = f"{file.name}: {inner.truncated}"
    _compare(head, counted, state)


def _metadata(path: Path) -> Mapping[str, Any]:
    file = path / "metadata.yaml"
    if not file.is_file():
        return {}
    if file.stat().st_size > _LONGEST:
        raise InputError(str(file), [f"has more than {_LONGEST} bytes: no description of a bag"])
    try:
        tree = yaml.safe_load(file.read_text("utf-8"))
        head = tree["rosbag2_bagfile_information"]
        if not isinstance(head, dict) or not isinstance(head["relative_file_paths"], list):
            raise TypeError("relative_file_paths is no list")
        if not all(isinstance(name, str) for name in head["relative_file_paths"]):
            raise TypeError("relative_file_paths holds something else than names")
        if int(head["version"]) > 9:
            raise ValueError(f"version {head['version']} is newer than 9")
    except (OSError, yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        text = f"is no description of a ROS 2 bag: {type(error).__name__}: {error}"
        raise InputError(str(file), [text[:400]]) from None
    return head


def _files(path: Path, head: Mapping[str, Any], state: State) -> list[Path]:
    if not head:
        found = [p for p in path.iterdir() if re.search(r"\.(db3|mcap)(\.zstd)?$", p.name)]
        if not found:
            raise InputError(str(path), ["holds neither metadata.yaml nor .db3 or .mcap files"])
        state.truncated = "there is no metadata.yaml: the bag was not closed"
        return sorted(found, key=_natural)
    distribution = head.get("ros_distro")
    state.about["ros_distro"] = distribution if isinstance(distribution, str) else ""
    # only names: a description must not lead out of its folder
    wanted = [path / PurePosixPath(str(name)).name for name in head["relative_file_paths"]]
    missing = [file.name for file in wanted if not file.is_file()]
    if missing and len(missing) == len(wanted):
        raise InputError(
            str(path), [f"{name} is missing; copy the whole folder" for name in missing]
        )
    for name in missing:
        state.damaged.append(f"{name} is named in metadata.yaml and is missing")
    return [file for file in wanted if file.is_file()]


def _natural(path: Path) -> list[tuple[int, str]]:
    parts = re.split(r"(\d+)", path.name)
    return [(int(part), "") if part.isdigit() else (0, part) for part in parts]


def _compare(head: Mapping[str, Any], counted: Mapping[str, int], state: State) -> None:
    """Topics of which fewer messages were found than the description says."""
    for entry in head.get("topics_with_message_count") or ():
        try:
            topic, count = str(entry["topic_metadata"]["name"]), int(entry["message_count"])
        except (KeyError, TypeError, ValueError):
            continue
        if counted.get(topic, 0) < count:
            state.expected[topic] = count


def _unpacked(file: Path) -> Path:
    """A storage file that was compressed as a whole, unpacked next to nothing else."""
    zstd = zstandard()
    most = max(LEAST_LIMIT, MOST_TIMES * file.stat().st_size)
    with tempfile.NamedTemporaryFile(delete=False, suffix=file.stem[-5:]) as out:
        target = Path(out.name)
        try:
            with file.open("rb") as raw, zstd.open(raw, "rb") as whole:
                while block := whole.read(_BLOCK):
                    out.write(block)
                    if out.tell() > most:
                        raise InputError(str(file), [f"unpacks to more than {most} bytes"])
        except (zstd.ZstdError, EOFError) as error:
            if not out.tell():
                target.unlink()
                raise InputError(str(file), [f"cannot be unpacked: {error}"]) from None
        except InputError:
            target.unlink()
            raise
    return target


def _message(data: bytes, file: Path) -> bytes:
    zstd = zstandard()
    most = max(LEAST_LIMIT, MOST_TIMES * len(data))
    try:
        return bytes(zstd.ZstdDecompressor().decompress(data, max_length=most))
    except zstd.ZstdError as error:
        raise InputError(str(file), [f"a message cannot be unpacked: {error}"]) from None


def sqlite_messages(path: Path, state: State) -> Iterator[Message]:
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
    told = head[24:28] == head[92:96]  # otherwise an old writer left the length as it was
    if len(head) < 100 or (told and wanted > size):
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
