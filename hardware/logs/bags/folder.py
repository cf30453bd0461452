"""ROS 2 bags: a folder with ``metadata.yaml`` and one or more files."""

from __future__ import annotations

import contextlib
import re
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import yaml

from simcompare.errors import InputError
from simcompare.hardware.logs.bags import reader
from simcompare.hardware.logs.bags.container import (
    MAX_RATIO,
    MIN_LIMIT,
    Message,
    State,
    zstandard,
)

_BLOCK = 1 << 20
#: bytes of a description: parsing YAML is slow
_MAX_BYTES = 1 << 22


@dataclass(frozen=True)
class _Description:
    """What ``metadata.yaml`` says.

    Attributes:
        files: names of the storage files; a description must not lead out of its folder.
        compression: "file", "message", or empty where the files say it themselves.
        distribution: of ROS 2 that recorded the bag.
        counts: topic -> number of its messages.
    """

    files: tuple[str, ...]
    compression: str
    distribution: str
    counts: Mapping[str, int]


def messages(path: Path, state: State) -> Iterator[Message]:
    """All messages of all files of a folder.

    Raises:
        InputError: it is no bag, files are missing, or it is of a version that is not known.
    """
    head = _described(path)
    mode = head.compression if head else ""
    counted: Counter[str] = Counter()
    for file in _files(path, head, state):
        source = _unpacked(file) if mode == "file" or file.suffix == ".zstd" else file
        inner = State()
        try:
            for connection, time, data in reader.of_file(source)(source, inner):
                counted[connection.topic] += 1
                yield connection, time, _message(data, file) if mode == "message" else data
        finally:
            if source is not file:
                source.unlink()
        state.connections.update(inner.connections)
        state.damaged += [f"{file.name}: {text}" for text in inner.damaged]
        if inner.truncated:
            state.truncated = f"{file.name}: {inner.truncated}"
    if head:
        state.expected |= {t: n for t, n in head.counts.items() if counted.get(t, 0) < n}


def _described(path: Path) -> _Description | None:
    """The description of a bag, ``None`` where there is none."""
    file = path / "metadata.yaml"
    if not file.is_file():
        return None
    if file.stat().st_size > _MAX_BYTES:
        raise InputError(str(file), [f"has more than {_MAX_BYTES} bytes: no description of a bag"])
    try:
        head = yaml.safe_load(file.read_text("utf-8"))["rosbag2_bagfile_information"]
        if not isinstance(head, dict) or not isinstance(head["relative_file_paths"], list):
            raise TypeError("relative_file_paths is no list")
        if not all(isinstance(name, str) for name in head["relative_file_paths"]):
            raise TypeError("relative_file_paths holds something else than names")
        if int(head["version"]) > 9:
            raise ValueError(f"version {head['version']} is newer than 9")
    except (OSError, yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        text = f"is no description of a ROS 2 bag: {type(error).__name__}: {error}"
        raise InputError(str(file), [text[:400]]) from None
    distribution = head.get("ros_distro")
    return _Description(
        tuple(PurePosixPath(name).name for name in head["relative_file_paths"]),
        str(head.get("compression_mode") or "").lower(),
        distribution if isinstance(distribution, str) else "",
        dict(_counts(head.get("topics_with_message_count") or ())),
    )


def _counts(entries: Iterable[Any]) -> Iterator[tuple[str, int]]:
    for entry in entries:
        with contextlib.suppress(KeyError, TypeError, ValueError):
            yield str(entry["topic_metadata"]["name"]), int(entry["message_count"])


def _files(path: Path, head: _Description | None, state: State) -> list[Path]:
    if head is None:
        storage = [p for p in path.iterdir() if re.search(r"\.(db3|mcap)(\.zstd)?$", p.name)]
        if not storage:
            raise InputError(str(path), ["holds neither metadata.yaml nor .db3 or .mcap files"])
        state.truncated = "there is no metadata.yaml: the bag was not closed"
        return sorted(storage, key=_natural)
    state.about["ros_distro"] = head.distribution
    files = [path / name for name in head.files]
    missing = [file.name for file in files if not file.is_file()]
    if missing and len(missing) == len(files):
        raise InputError(
            str(path), [f"{name} is missing; copy the whole folder" for name in missing]
        )
    for name in missing:
        state.damaged.append(f"{name} is named in metadata.yaml and is missing")
    return [file for file in files if file.is_file()]


def _natural(path: Path) -> list[tuple[int, str]]:
    parts = re.split(r"(\d+)", path.name)
    return [(int(part), "") if part.isdigit() else (0, part) for part in parts]


def _unpacked(file: Path) -> Path:
    """A storage file that was compressed as a whole, unpacked next to nothing else."""
    zstd = zstandard()
    most = max(MIN_LIMIT, MAX_RATIO * file.stat().st_size)
    with tempfile.NamedTemporaryFile(delete=False, suffix=file.stem[-5:]) as out:
        target = Path(out.name)
        try:
            with file.open("rb") as raw, zstd.open(raw, "rb") as unpacked:
                while block := unpacked.read(_BLOCK):
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
    most = max(MIN_LIMIT, MAX_RATIO * len(data))
    try:
        return bytes(zstd.ZstdDecompressor().decompress(data, max_length=most))
    except zstd.ZstdError as error:
        raise InputError(str(file), [f"a message cannot be unpacked: {error}"]) from None
