"""Uploads: streamed into a file, never larger than allowed, kept whole or not at all."""

from __future__ import annotations

import asyncio
import json
import math
import re
import secrets
from collections.abc import AsyncIterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from starlette.requests import ClientDisconnect, Request

from simcompare.lab import contents, groups
from simcompare.lab.groups import Group
from simcompare.lab.refusals import Refused
from simcompare.model import whole

#: largest request of JSON; bytes that are written at once
JSON_BYTES, _AT_ONCE = 10**6, 2**20
#: lists and tables within each other, at most
_DEEPEST = 8
#: longest time for an upload [s]: what each may take, and for every byte; no more than all of it
_EACH_S, _BYTE_S, _WHOLE_S = 30.0, 1 / 20_000, 900.0


@dataclass(frozen=True)
class Upload:
    """What came.

    Attributes:
        id: of the recording.
        kind: sound, video or table, by its content.
        name: as the sender calls it; for people.
        path: of the file.
    """

    id: str
    kind: str
    name: str
    path: Path


async def document(request: Request) -> dict[str, Any]:
    """The JSON object that a request brings.

    Raises:
        Refused: it is too large, or no such object.
    """
    if request.headers.get("content-type", "").split(";")[0].strip() != "application/json":
        raise Refused(415, "json_wanted")
    raw = bytearray()
    async for part in _parts(request, JSON_BYTES):
        raw += part
    try:
        found = json.loads(raw, parse_constant=_number, parse_float=_number, parse_int=_whole)
    except (ValueError, RecursionError):
        raise Refused(400, "bad_json") from None
    if not isinstance(found, dict) or _depth(found) > _DEEPEST:
        raise Refused(400, "bad_json")
    return found


async def recording(request: Request, group: Group, name: str, wish: str) -> Upload:
    """Stores the file that a request brings.

    Args:
        request: its body is the file.
        group: whose it is.
        name: as the sender calls it.
        wish: kind that the sender says it is.

    Raises:
        Refused: it is too large, of no kind that can be used, or did not come to its end.
    """
    _check_announced(request)
    await asyncio.to_thread(group.make_room, max(contents.LARGEST.values()))
    parts = _parts(request, max(contents.LARGEST.values()))
    head = bytearray()
    async for part in parts:
        head += part
        if len(head) >= contents.LOOKED_AT:
            break
    kind, ending = _kind(bytes(head[: contents.LOOKED_AT]), wish)
    place = group.folder / "recordings" / secrets.token_hex(8)
    upload = Upload(place.name, kind, shown(name), place / f"source.{ending}")
    with whole.folder(place) as made:
        size = await _write(made / upload.path.name, head, parts, contents.LARGEST[kind])
        (made / "upload.json").write_text(json.dumps(_told(upload, size)), encoding="utf-8")
    return upload


def kept(place: Path) -> Upload:
    """A recording that was stored before.

    Raises:
        Refused: its file is gone.
    """
    path = next(iter(sorted(place.glob("source.*"))), None)
    told = groups.document(place / "upload.json")
    if path is None or told.get("kind") not in contents.LARGEST:
        raise Refused(404, "no_recording")
    return Upload(place.name, told["kind"], str(told.get("name", "")), path)


def shown(name: str) -> str:
    """A name of a file as it may be shown: the last part of a path, printable, not long."""
    last = re.split(r"[/\\]", name)[-1]
    return "".join(letter for letter in last if letter.isprintable())[:80]


def _told(upload: Upload, size: int) -> dict[str, object]:
    when = datetime.now(UTC).isoformat(timespec="seconds")
    return {"name": upload.name, "kind": upload.kind, "bytes": size, "when": when}


def _kind(head: bytes, wish: str) -> tuple[str, str]:
    if not head:
        raise Refused(400, "empty_file")
    found = contents.kind_of(head, wish)
    if found is None:
        raise Refused(415, "unknown_content")
    return found


def _check_announced(request: Request) -> None:
    """Refuses what says beforehand that it is too large."""
    announced = request.headers.get("content-length", "0")
    largest = max(contents.LARGEST.values())
    if not announced.isascii() or not announced.isdigit() or len(announced) > 15:
        raise Refused(400, "bad_length")
    if int(announced) > largest:
        raise _too_large(largest)


async def _write(path: Path, head: bytearray, parts: AsyncIterator[bytes], most: int) -> int:
    """Writes what comes, in large parts; how many bytes it was."""
    size, held = 0, bytearray(head)
    with path.open("xb") as file:
        while held:
            size += len(held)
            if size > most:
                raise _too_large(most)
            await asyncio.to_thread(file.write, held)
            held = bytearray()
            async for part in parts:
                held += part
                if len(held) >= _AT_ONCE:
                    break
    return size


async def _parts(request: Request, most: int) -> AsyncIterator[bytes]:
    """The body as it comes; who sends too slowly, or goes away, is refused."""
    loop, stream = asyncio.get_running_loop(), request.stream()
    begun, size = loop.time(), 0
    while True:
        try:
            async with asyncio.timeout_at(begun + min(_EACH_S + _BYTE_S * size, _WHOLE_S)):
                part = await anext(stream)
        except StopAsyncIteration:
            return
        except TimeoutError:
            raise Refused(408, "too_slow") from None
        except ClientDisconnect:
            raise Refused(400, "cut_short") from None
        size += len(part)
        if size > most:
            raise _too_large(most)
        yield part


def _too_large(most: int) -> Refused:
    return Refused(413, "too_large", most=most // 10**6)


def _number(text: str) -> float:
    """A number that is finite; ``ValueError`` where it is not."""
    if not math.isfinite(found := float(text)):
        raise ValueError(f"{text} is not finite")
    return found


def _whole(text: str) -> int:
    """A whole number that is also one with a point."""
    _number(text)
    return int(text)


def _depth(value: object, so_far: int = 0) -> int:
    """How many lists and tables lie in each other, as far as that is allowed."""
    inside = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    if so_far > _DEEPEST:
        return so_far
    return max((_depth(one, so_far + 1) for one in inside), default=so_far)
