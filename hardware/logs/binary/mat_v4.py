"""Whether a file is one of MATLAB version 4, and whether it is whole; it has no mark of its own.

Each variable begins with five whole numbers: a code of type and byte order, rows, columns, whether
it is complex, and the length of its name. Simulink's "To File" and Quanser's QUARC write it.
"""

from __future__ import annotations

import struct
from pathlib import Path

#: bytes of one number, by the third digit of the code
_SIZES = (8, 4, 4, 2, 2, 1)
_HEAD = 20
_MAX_NAME = 64


def begins(start: bytes) -> bool:
    """Whether a file begins with a variable of version 4."""
    return _variable(start[:_HEAD], start[_HEAD : _HEAD + _MAX_NAME]) > 0


def fault(path: Path) -> str:
    """What is wrong with a file, empty where it is whole."""
    size = path.stat().st_size
    at = 0
    with path.open("rb") as file:
        while at < size:
            file.seek(at)
            head = file.read(_HEAD)
            length = _variable(head, file.read(_MAX_NAME))
            if not length:
                return f"byte {at}: no variable of version 4 begins here"
            if at + length > size:
                return f"byte {at}: a variable of {length} bytes begins, and the file ends before"
            at += length
    return ""


def _variable(head: bytes, rest: bytes) -> int:
    """Bytes of a variable with its head; 0 where none begins."""
    for order in "<>":
        code, rows, columns, is_complex, name = (
            struct.unpack(f"{order}5i", head) if len(head) == _HEAD else (-1,) * 5
        )
        machine, precision, kind = code // 1000, code // 10 % 10, code % 10
        known = machine == "<>".index(order) and 0 <= precision < len(_SIZES) and 0 <= kind <= 1
        known = known and code // 100 % 10 == 0 and is_complex in (0, 1)
        if known and rows >= 0 and columns >= 0 and 1 < name <= _MAX_NAME and _is_name(rest[:name]):
            return int(_HEAD + name + rows * columns * _SIZES[precision] * (1 + is_complex))
    return 0


def _is_name(text: bytes) -> bool:
    """A letter, then letters, digits and underscores, and a zero at the end."""
    plain = text[:-1]
    return text[-1:] == b"\0" and plain.isascii() and plain.decode("ascii").isidentifier()
