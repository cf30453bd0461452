"""Frames between two processes: a head in JSON, and arrays as they lie in memory.

Nothing in a frame can be executed. What is no whole frame is refused: an engine may write to
every descriptor of its process.
"""

from __future__ import annotations

import contextlib
import json
import os
import socket
import struct
import zlib
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simcompare.model.plain import Plain

Arrays = Sequence[NDArray[Any]]
#: bytes of a head: audits, notes and answers, which are a few thousand lines at most
MOST_HEAD_BYTES = 16 * 2**20
#: numbers that an array may hold
_KINDS = frozenset(["<f8", "<f4", "<i8", "<i4", "<i2", "|i1", "|u1", "<u2", "<u4", "<u8", "|b1"])
_MOST_DIMENSIONS = 2
_MARK = b"\x93simcmp\n"
#: mark, what the frame ends with, bytes of the head and of all arrays, checksum of the head
_START = struct.Struct("<8s8sQQI")
_END_BYTES = 8


class BadFrame(ValueError):
    """What came is no frame, or none that is expected."""


def send(connection: socket.socket, head: Plain, arrays: Arrays = ()) -> None:
    """Sends one frame.

    Raises:
        ValueError: an array holds something else than numbers, or the head is too long.
        TypeError: the head is not plain.
    """
    flat = [np.ascontiguousarray(array) for array in arrays]
    kinds = [(array.dtype.str, array.shape) for array in flat]
    if odd := sorted({kind for kind, _ in kinds} - _KINDS):
        raise ValueError(f"an array of {', '.join(odd)} is not sent; expected numbers")
    text = json.dumps({**head, "arrays": kinds}).encode()
    if len(text) > MOST_HEAD_BYTES:
        raise ValueError(f"{len(text)} bytes beside the arrays are too many")
    end = os.urandom(_END_BYTES)
    size = sum(array.nbytes for array in flat)
    connection.sendall(_START.pack(_MARK, end, len(text), size, zlib.crc32(text)) + text)
    for array in flat:
        if array.nbytes:
            connection.sendall(array.data.cast("B"))
    connection.sendall(end)


def receive(
    connection: socket.socket, most_bytes: Callable[[], int]
) -> tuple[Plain, Arrays] | None:
    """Receives one frame; ``None`` where the other process is gone, also within a frame.

    Args:
        connection: to the other process.
        most_bytes: of all its arrays, as it is when a frame has begun.

    Raises:
        BadFrame: what came is no frame, or is too large.
    """
    start = bytearray(_START.size)
    if not _filled(connection, memoryview(start)):
        return None
    mark, end, text_bytes, body_bytes, checksum = _START.unpack(start)
    if mark != _MARK:
        raise BadFrame("bytes that are no frame")
    most = most_bytes()
    if text_bytes > MOST_HEAD_BYTES or body_bytes > most:
        raise BadFrame(f"{text_bytes + body_bytes} bytes; expected at most {most}")
    text, tail = bytearray(text_bytes), bytearray(_END_BYTES)
    # not filled with zeros first
    body = np.empty(body_bytes, np.uint8).data
    if not all(_filled(connection, part) for part in (memoryview(text), body, memoryview(tail))):
        return None
    if tail != end or zlib.crc32(text) != checksum:
        raise BadFrame("a frame with other bytes in between")
    return _parsed(text, body)


def _filled(connection: socket.socket, left: memoryview) -> bool:
    """Whether there was enough to fill all of it."""
    with contextlib.suppress(ConnectionResetError):  # it ended without reading all that it was sent
        while left:
            count = connection.recv_into(left)
            if not count:
                return False
            left = left[count:]
        return True
    return False


def _parsed(text: bytes | bytearray, body: memoryview) -> tuple[Plain, Arrays]:
    try:
        head = json.loads(text)
        kinds = [(str(kind), tuple(map(int, shape))) for kind, shape in head.pop("arrays")]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise BadFrame(f"a head that cannot be read ({type(error).__name__})") from None
    arrays, begin = [], 0
    for kind, shape in kinds:
        if kind not in _KINDS or len(shape) > _MOST_DIMENSIONS or min(shape, default=0) < 0:
            raise BadFrame("an array that is none of numbers")
        end = begin + np.dtype(kind).itemsize * int(np.prod(shape, dtype=object))
        if end > len(body):
            raise BadFrame("arrays that are longer than their frame")
        arrays.append(np.frombuffer(body[begin:end], kind).reshape(shape))
        begin = end
    if begin != len(body):
        raise BadFrame("arrays that are shorter than their frame")
    return head, arrays
