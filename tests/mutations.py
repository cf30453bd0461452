"""Seeded damage to valid logs: what transfers, editors, dying recorders and bad luck do to files.

``mutated(log, seed, others)`` is the same on every machine for the same bytes. Each mutation has
a kind, so that what must be noticed can be told (see ``fuzzing``).
"""

from __future__ import annotations

import io
import random
import re
import sqlite3
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.text_mutations import HUGE, Edit, text_edits
from tests.text_samples import Log


@dataclass(frozen=True)
class Mutation:
    """A damaged log.

    Attributes:
        files: as those of the log.
        kinds: what was done, in order.
    """

    files: dict[str, bytes]
    kinds: tuple[str, ...]


def mutated(log: Log, seed: int, others: Sequence[Log]) -> Mutation:
    """One to four edits of one of the files of a log."""
    chance = random.Random(f"{log.name} {seed}")
    files = dict(log.files)
    edits = _edits(log, others)
    kinds = []
    for _ in range(chance.choice((1, 1, 1, 1, 2, 4))):
        # one file of a folder; the large one more often
        name = chance.choices(list(files), [len(data) + 2000 for data in files.values()])[0]
        kind = chance.choice(sorted(edits))
        files[name] = edits[kind](chance, files[name]) or b"\n"
        kinds.append(kind)
    if len(files) > 1 and chance.random() < 0.03:
        del files[chance.choice(sorted(files))]
        kinds.append("file removed")
    return Mutation(files, tuple(kinds))


def _edits(log: Log, others: Sequence[Log]) -> dict[str, Edit]:
    found: dict[str, Edit] = dict(_BYTES)
    found["splice"] = lambda chance, data: _splice(chance, data, others)
    if log.is_text:
        # text that is no text any more is tried as well, more rarely
        found = {kind: found[kind] for kind in ("flip", "cut", "delete", "splice", "repeat")}
        found |= text_edits(log.encoding)
    first = next(iter(log.files.values()))
    for start, edits in _CONTAINERS:
        if any(data.startswith(start) for data in (first, *log.files.values())):
            found |= {kind: _whole(edit) for kind, edit in edits.items()}
    return found


def _whole(edit: Edit) -> Edit:
    """An edit of a container; what is damaged already gets a flipped bit instead."""

    def done(chance: random.Random, data: bytes) -> bytes:
        try:
            return edit(chance, data)
        except Exception:  # noqa: BLE001  (it was damaged by the edit before)
            return _flip(chance, data)

    return done


# ---- bytes ------------------------------------------------------------------------------------


def _at(chance: random.Random, data: bytes) -> int:
    """A place; headers are hit as often as all the rest."""
    if chance.random() < 0.4:
        return chance.randrange(min(len(data), 512) + 1)
    return chance.randrange(len(data) + 1)


def _span(chance: random.Random, data: bytes) -> tuple[int, int]:
    start = _at(chance, data)
    return start, min(start + chance.choice((1, 1, 2, 4, 8, 64, 512, 4096)), len(data))


def _flip(chance: random.Random, data: bytes) -> bytes:
    changed = bytearray(data)
    for _ in range(chance.choice((1, 1, 2, 8))):
        if changed:
            at = min(_at(chance, data), len(changed) - 1)
            changed[at] ^= 1 << chance.randrange(8)
    return bytes(changed)


def _cut(chance: random.Random, data: bytes) -> bytes:
    return data[: chance.randrange(len(data) + 1)]


def _delete(chance: random.Random, data: bytes) -> bytes:
    start, stop = _span(chance, data)
    return data[:start] + data[stop:]


def _insert(chance: random.Random, data: bytes) -> bytes:
    at = _at(chance, data)
    new = chance.choice((chance.randbytes(chance.randrange(1, 200)), b"\0" * 8, b"\xff" * 16))
    return data[:at] + new + data[at:]


def _zero(chance: random.Random, data: bytes) -> bytes:
    start, stop = _span(chance, data)
    return data[:start] + chance.choice((b"\0", b"\xff")) * (stop - start) + data[stop:]


def _swap(chance: random.Random, data: bytes) -> bytes:
    a, b, c, d = sorted(_at(chance, data) for _ in range(4))
    return data[:a] + data[c:d] + data[b:c] + data[a:b] + data[d:]


def _repeat(chance: random.Random, data: bytes) -> bytes:
    start, stop = _span(chance, data)
    return data[:stop] + data[start:stop] * chance.choice((1, 1, 3)) + data[stop:]


def _splice(chance: random.Random, data: bytes, others: Sequence[Log]) -> bytes:
    """The beginning of this file and the end of another one."""
    other = chance.choice([d for log in others for d in log.files.values()])
    return data[: _at(chance, data)] + other[chance.randrange(len(other) + 1) :]


def _huge(chance: random.Random, data: bytes) -> bytes:
    """A field that may be a length, as large as it can be."""
    size = chance.choice((2, 4, 4, 8, 8))
    order: Any = chance.choice(("little", "little", "big"))
    at = (
        _at(chance, data) // chance.choice((1, 4)) * 4
        if chance.random() < 0.5
        else _at(chance, data)
    )
    value = chance.choice(HUGE) & ((1 << 8 * size) - 1)
    return data[:at] + value.to_bytes(size, order) + data[at + size :]


_BYTES: dict[str, Edit] = {
    "flip": _flip, "cut": _cut, "delete": _delete, "insert": _insert, "zero": _zero,
    "swap": _swap, "repeat": _repeat, "huge": _huge,
}  # fmt: skip


# ---- containers -------------------------------------------------------------------------------


def _zip_member(chance: random.Random, data: bytes) -> bytes:
    """A damaged member in an archive that is whole."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    name = chance.choice(sorted(members))
    what = chance.randrange(8)
    if what == 0:
        del members[name]
    elif what == 1:
        members[chance.choice(("../out", "/abs", "a/b", name + "\u202e", ""))] = members.pop(name)
    elif what == 2:
        members[name] = b""
    elif what == 3:
        members[name] = chance.choice(sorted(members.values()))
    else:
        members[name] = chance.choice(list(_BYTES.values()))(chance, members[name])
    return _zip(members, chance)


def _zip_bomb(chance: random.Random, data: bytes) -> bytes:
    """A few kilobytes that unpack to many megabytes."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    name = chance.choice(sorted(members))
    filling = chance.choice((b"\0", b"0.5,", b"1\n", b" ", members[name][-40:] or b"0"))
    members[name] += filling * (chance.choice((4, 40)) * 2**20 // len(filling))
    return _zip(members, chance, zipfile.ZIP_DEFLATED)


def _zip(members: dict[str, bytes], chance: random.Random, how: int | None = None) -> bytes:
    buffer = io.BytesIO()
    kinds = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)
    how = chance.choice(kinds) if how is None else how
    with zipfile.ZipFile(buffer, "w", how) as archive:
        for name, content in members.items():
            archive.writestr(zipfile.ZipInfo(name, (2024, 1, 1, 0, 0, 0)), content, how)
    return buffer.getvalue()


def _npy_header(chance: random.Random, data: bytes) -> bytes:
    """Another shape or type in the header of an array."""
    at = data.index(b"{")
    end = data.index(b"}", at) + 1
    header = data[at:end].decode("latin-1")
    number = str(chance.choice((*HUGE, 0, -1, 1, 7, 119, 121)))
    changes = (
        (r"\d+(?=,?\s*\))", number), (r"'shape': \([^)]*\)", f"'shape': ({number}, {number})"),
        (r"<[fi]\d", chance.choice(("<f16", "|O", "<U9", "<c16", "<M8[ns]", ">f2", "|V8", "<i8"))),
        (r"False", "True"), (r"True", "False"), (r"'shape'", "'shape_'"), (r"\(", "[(" * 200),
    )  # fmt: skip
    pattern, new = chance.choice(changes)
    changed = re.sub(pattern, lambda _: new, header, count=1).encode("latin-1")
    size = len(changed) + 1
    return (
        data[:6] + b"\x01\0" + struct.pack("<H", size) + changed + b"\n" + data[end:].lstrip(b" \n")
    )


def _riff_field(chance: random.Random, data: bytes) -> bytes:
    """A field of the header of a sound."""
    at, size = chance.choice(
        ((4, 4), (16, 4), (20, 2), (22, 2), (24, 4), (28, 4), (32, 2), (34, 2), (40, 4))
    )
    value = chance.choice((*HUGE, 0, 1, 2, 3, 8, 24, 64, 255, 65535)) & ((1 << 8 * size) - 1)
    return data[:at] + value.to_bytes(size, "little") + data[at + size :]


def _tdms_field(chance: random.Random, data: bytes) -> bytes:
    """The lead-in of a segment, or the number of values of a channel."""
    starts = [match.start() for match in re.finditer(b"TDSm", data)]
    at = chance.choice(starts)
    offset = chance.choice((4, 8, 12, 20, 28))
    if chance.random() < 0.5:  # index of raw data: type, dimension, number of values
        places = [m.start() for m in re.finditer(re.escape(struct.pack("<I", 20)), data)]
        at, offset = chance.choice(places), chance.choice((4, 8, 12))
    size = 8 if offset in (12, 20) else 4
    value = chance.choice((*HUGE, 0, 1, 2, 0xFFFFFFFF, 1 << 3, 1 << 5)) & ((1 << 8 * size) - 1)
    return data[: at + offset] + value.to_bytes(size, "little") + data[at + offset + size :]


def _mat_inside(chance: random.Random, data: bytes) -> bytes:
    """A damaged variable, packed again where it was packed."""
    at, found = 128, []
    while at + 8 <= len(data):
        kind, length = struct.unpack_from("<II", data, at)
        found.append((at, kind, length))
        at += 8 + length
    at, kind, length = chance.choice(found)
    body = data[at + 8 : at + 8 + length]
    plain = zlib.decompress(body) if kind == 15 else body
    if chance.random() < 0.15:
        plain += b"\0" * (chance.choice((4, 40)) * 2**20)
    else:
        plain = chance.choice((_flip, _huge, _huge, _cut, _zero, _delete))(chance, plain)
    packed = zlib.compress(plain) if kind == 15 else plain
    return data[:at] + struct.pack("<II", kind, len(packed)) + packed + data[at + 8 + length :]


def _mcap_chunk(chance: random.Random, data: bytes) -> bytes:
    """Damage within a chunk of which the check sum is left out."""
    at = 8
    while data[at] != 6:
        at += 9 + struct.unpack_from("<Q", data, at + 1)[0]
    size = struct.unpack_from("<Q", data, at + 1)[0]
    body = data[at + 9 : at + 9 + size]
    name = struct.unpack_from("<I", body, 28)[0]
    inside = body[32 + name + 8 :]
    if body[32 : 32 + name] == b"zstd":
        from backports import zstd

        inside = zstd.decompress(inside)
    inside = chance.choice((_flip, _huge, _cut, _zero, _delete, _swap))(chance, inside)
    if chance.random() < 0.1:
        inside += b"\0" * (40 * 2**20)
    told = len(inside) if chance.random() < 0.8 else chance.choice(HUGE) & (2**64 - 1)
    packed = inside
    if body[32 : 32 + name] == b"zstd":
        packed = zstd.compress(inside)
    chunk = body[:16] + struct.pack("<QI", told, 0) + body[28 : 32 + name]
    chunk += struct.pack("<Q", len(packed)) + packed
    return data[:at] + struct.pack("<BQ", 6, len(chunk)) + chunk + data[at + 9 + size :]


def _sql(chance: random.Random, data: bytes) -> bytes:
    """Wrong values in a data base that is whole."""
    value = chance.choice(("NULL", "'text'", "-1", "9223372036854775807", "1e300", "x'00'",
                           "zeroblob(40000000)", "id", "x'0001'", "zeroblob(340)"))  # fmt: skip
    place = chance.choice((
        "messages SET data", "messages SET timestamp", "messages SET topic_id", "topics SET type",
        "topics SET name", "topics SET serialization_format", "message_definitions SET"
        " encoded_message_definition", "message_definitions SET encoding",
    ))  # fmt: skip
    table = place.partition(" ")[0]
    some = f" WHERE rowid IN (SELECT rowid FROM {table} ORDER BY rowid LIMIT 1 OFFSET"
    where = f"{some} {chance.randrange(40)})" if chance.random() < 0.7 or "zero" in value else ""
    change = f"UPDATE {place} = {value}{where}"
    if chance.random() < 0.15:
        change = f"DROP TABLE {table}" if chance.random() < 0.3 else f"DELETE FROM {table}{where}"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.db3"
        path.write_bytes(data)
        base = sqlite3.connect(path)
        base.execute(change)
        base.commit()
        base.close()
        return path.read_bytes()


#: how a container begins -> edits that keep it whole as a container
_CONTAINERS: tuple[tuple[bytes, dict[str, Edit]], ...] = (
    (b"PK\x03\x04", {"zip member": _zip_member, "zip bomb": _zip_bomb}),
    (b"\x93NUMPY", {"npy header": _npy_header, "npy header ": _npy_header}),
    (b"RIFF", {"riff field": _riff_field, "riff field ": _riff_field}),
    (b"TDSm", {"tdms field": _tdms_field, "tdms field ": _tdms_field}),
    (b"MATLAB 5", {"mat inside": _mat_inside, "mat inside ": _mat_inside}),
    (b"\x89MCAP", {"mcap chunk": _mcap_chunk}),
    (b"SQLite", {"sql": _sql, "sql ": _sql}),
)
