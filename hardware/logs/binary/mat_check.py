"""Whether a MATLAB file of version 5 to 7 is built as it must be, before anything is made of it.

The library that reads it trusts what the file says of itself: a damaged type or length can end the
whole program, or claim all memory. So every element is gone through first, a piece at a time:
its length must lie within the one around it, its type be known, its size fit the dimensions.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

_MATRIX, _COMPRESSED = 14, 15
#: bytes of one number of each type; what is no number has 1
_NUMBERS = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}
_TEXTS = {1: 1, 2: 1, 4: 2, 16: 1, 17: 2, 18: 4}
_UINT32 = 6
_SIZES, _NAMES = {5: 4, 6: 4}, {1: 1, 16: 1}
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE, _FUNCTION, _OPAQUE = 1, 2, 3, 4, 5, 16, 17
_COMPLEX = 0x0800
_TAG = 8
_MAX_DIMENSIONS, _MAX_DEPTH, _MAX_NAME = 32, 32, 256
_PIECE = 1 << 18
#: a variable may become so much larger, or at least this large, when it is unpacked
MAX_RATIO, MIN_LIMIT = 64, 1 << 28


class Damaged(Exception):
    """An element is not as it must be; the text says which."""


def check(path: Path) -> None:
    """Goes through all variables.

    Raises:
        Damaged: with the byte at which the variable begins.
    """
    size = path.stat().st_size
    most = max(MIN_LIMIT, MAX_RATIO * size)
    names: set[bytes] = set()
    with path.open("rb") as file:
        order = {b"IM": "<", b"MI": ">"}.get(file.read(128)[126:128])
        if order is None:
            raise Damaged("byte 126: no mark of the byte order ('IM') stands there")
        at = 128
        while at + _TAG <= size:
            file.seek(at)
            kind, length = _two(file.read(_TAG), order)
            missing = at + _TAG + length - size
            if missing > 0:
                raise Damaged(
                    f"byte {at}: a variable of {length} bytes begins, and {missing} of them are"
                    " missing; the file is truncated, copy it again"
                )
            try:
                name, unpacked = _variable(file, kind, length, most, order)
                if name and name in names:
                    raise Damaged(f"has the name {name!r}, as another one has")
            except Damaged as fault:
                raise Damaged(f"byte {at}: the variable that begins there {fault}") from None
            names.add(name)
            most -= unpacked
            at += _TAG + length


def _variable(file: BinaryIO, kind: int, length: int, most: int, order: str) -> tuple[bytes, int]:
    """Its name, and how long it is unpacked (0 where it is not compressed)."""
    if kind == _MATRIX:
        walk = _Walk(_Bounded(file.read, length).take, order)
        walk.matrix(length, 0)
        return walk.name, 0
    if kind != _COMPRESSED:
        raise Damaged(f"is of the type {kind}; expected 14 or 15")
    source = _Unpacked(file, length, most)
    kind, size = _two(source.take(_TAG), order)
    if kind != _MATRIX:
        raise Damaged(f"holds an element of the type {kind}; expected {_MATRIX}")
    walk = _Walk(source.take, order)
    walk.matrix(size, 0)
    if not source.ended():
        raise Damaged("is followed by more than fits into its element")
    return walk.name, source.count


def _two(data: bytes, order: str) -> tuple[int, int]:
    end = "little" if order == "<" else "big"
    return int.from_bytes(data[:4], end), int.from_bytes(data[4:8], end)  # type: ignore[arg-type]


class _Unpacked:
    """A compressed variable, unpacked a piece at a time."""

    def __init__(self, file: BinaryIO, length: int, most: int) -> None:
        self._file, self._left, self._most = file, length, most
        self._zlib = zlib.decompressobj()
        self._ready = b""
        self.count = 0

    def take(self, count: int) -> bytes:
        """The next bytes.

        Raises:
            Damaged: there are not so many, or more than is plausible.
        """
        while len(self._ready) < count:
            if not self._more():
                raise Damaged("ends too early")
        self.count += count
        if self.count > self._most:
            raise Damaged(f"unpacks to more than {self._most >> 20} MB, which is not plausible")
        data, self._ready = self._ready[:count], self._ready[count:]
        return data

    def ended(self) -> bool:
        """Whether nothing is left."""
        while not self._ready and self._more():
            pass
        return not self._ready

    def _more(self) -> bool:
        """Unpacks another piece; false where there is none."""
        piece = self._zlib.unconsumed_tail
        if not piece:
            piece = self._file.read(min(_PIECE, self._left))
            self._left -= len(piece)
        try:
            new = self._zlib.decompress(piece, _PIECE)
        except zlib.error as error:
            raise Damaged(f"cannot be unpacked ({error})") from None
        self._ready += new
        return bool(new or piece)


class _Walk:
    """Goes through a variable, element by element."""

    def __init__(self, take: Callable[[int], bytes], order: str) -> None:
        self._take, self._order = take, order
        self.name = b""

    def matrix(self, size: int, depth: int) -> None:
        """A variable, or a cell or field within one."""
        if depth > _MAX_DEPTH:
            raise Damaged("is nested too deeply")
        if size == 0:
            return  # an empty cell
        end = _Bounded(self._take, size)
        inner = _Walk(end.take, self._order)
        if _two(end.take(8), self._order) != (_UINT32, 8):
            raise Damaged("does not begin with its flags")
        number = _two(end.take(8), self._order)[0]
        kind, complex_ = number & 0xFF, bool(number & _COMPLEX)
        if kind == _OPAQUE:
            inner._opaque(depth)
            end.skip()
            return
        dimensions = inner._numbers(inner._data(_SIZES, 4 * _MAX_DIMENSIONS, "its size"))
        if len(dimensions) < 2 or min(dimensions) < 0:
            raise Damaged(f"has the size {dimensions}")
        name = inner._data(_NAMES, _MAX_NAME, "its name")
        if not depth:
            self.name = name
        inner._content(kind, complex_, math.prod(dimensions), end, depth)
        end.skip()

    def _content(self, kind: int, complex_: bool, count: int, end: _Bounded, depth: int) -> None:
        if kind in (_CELL, _STRUCT, _OBJECT):
            self._parts(kind, count, end, depth)
        elif kind == _FUNCTION:
            self._inner(depth)
        elif kind == _SPARSE:
            for _ in range(4 if complex_ else 3):
                self._skipped(_NUMBERS, None)
        elif kind == _CHAR:
            self._skipped(_TEXTS, None)
        elif 6 <= kind <= 15:
            for _ in range(2 if complex_ else 1):
                self._skipped(_NUMBERS, count)
        else:
            raise Damaged(f"is of the unknown class {kind}")

    def _parts(self, kind: int, count: int, end: _Bounded, depth: int) -> None:
        if kind == _OBJECT:
            self._data(_NAMES, _MAX_NAME, "the name of its class")
        fields = 1
        if kind != _CELL:
            length = sum(self._numbers(self._data(_SIZES, 4, "the length of its names")))
            names = self._data(_NAMES, 1 << 20, "the names of its fields")
            if not 0 < length <= _MAX_NAME or len(names) % length:
                raise Damaged(f"has names of {length} of {len(names)} bytes")
            fields = len(names) // length
        # each part has a tag at least; structs without fields must not be without bounds either
        if count * max(fields, 1) * _TAG > max(end.rest, 1000 * _TAG):
            raise Damaged(f"says that it has {count * fields} parts; {end.rest} bytes are there")
        for _ in range(count * fields):
            self._inner(depth)

    def _opaque(self, depth: int) -> None:
        """Texts and a variable; what they mean is not documented."""
        for _ in range(4):
            kind, size, data = self._tag()
            if kind == _MATRIX:
                self.matrix(size, depth + 1)
                return
            if kind not in _NAMES or size > _MAX_NAME:
                break
            if not data:
                self._take(size + -size % 8)
        raise Damaged("is an object of an unknown kind")

    def _inner(self, depth: int) -> None:
        kind, size = _two(self._take(8), self._order)
        if kind != _MATRIX:
            raise Damaged(f"holds an element of the type {kind}; expected 14")
        self.matrix(size, depth + 1)

    def _tag(self) -> tuple[int, int, bytes]:
        """Type and length of the next element, and its data where they stand in the tag."""
        tag = self._take(8)
        kind, size = _two(tag, self._order)
        if kind >> 16:
            kind, size = kind & 0xFFFF, kind >> 16
            if size > 4:
                raise Damaged(f"holds a short element of {size} bytes")
            return kind, size, tag[4 : 4 + size]
        return kind, size, b""

    def _data(self, kinds: dict[int, int], most: int, what: str) -> bytes:
        """A short element as a whole."""
        kind, size, data = self._tag()
        if kind not in kinds or size > most or size % kinds[kind]:
            raise Damaged(f"has an element of type {kind} with {size} bytes for {what}")
        if not data and size:
            data = self._take(size)
            self._take(-size % 8)
        return data

    def _numbers(self, data: bytes) -> list[int]:
        end = "little" if self._order == "<" else "big"
        return [
            int.from_bytes(data[i : i + 4], end, signed=True)  # type: ignore[arg-type]
            for i in range(0, len(data), 4)
        ]

    def _skipped(self, kinds: dict[int, int], count: int | None) -> None:
        """An element of numbers or text: its type and length alone are looked at."""
        kind, size, data = self._tag()
        if kind not in kinds or (count is not None and size % kinds[kind]):
            raise Damaged(f"holds {size} bytes of the type {kind}, which is none of its values")
        if count is not None and size // kinds[kind] != count:
            raise Damaged(f"holds {size // kinds[kind]} numbers; its size says {count}")
        if not data:
            rest = size + -size % 8
            while rest:
                rest -= len(self._take(min(rest, _PIECE)))


class _Bounded:
    """An element within another one."""

    def __init__(self, take: Callable[[int], bytes], size: int) -> None:
        self._take, self.rest = take, size

    def take(self, count: int) -> bytes:
        """The next bytes, which must lie within the element."""
        if count > self.rest:
            raise Damaged("has a part that is longer than itself")
        self.rest -= count
        return self._take(count)

    def skip(self) -> None:
        """The rest of the element."""
        while self.rest:
            self.take(min(self.rest, _PIECE))
