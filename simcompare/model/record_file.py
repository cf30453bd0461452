"""JSON files of ours, read back into typed records; whatever is damaged is told with its place."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from simcompare.errors import InputError
from simcompare.model import whole
from simcompare.model.plain import faults, of_plain, plain

Record = TypeVar("Record")
#: whole numbers above it are none that we wrote: float64 does not hold each of them
_LARGEST = 1 << 53
#: largest file: far more than a description has, as numbers of samples are in tables
_MOST_BYTES = 64 * 10**6
#: unknown names that are listed
_LISTED = 3


def read(path: Path, again: str) -> object:
    """The plain values of a file.

    Args:
        path: the file.
        again: what makes it anew, such as "run it again".

    Raises:
        InputError: it cannot be read, is too large, or is no JSON.
    """
    try:
        with whole.opened(path, links=True) as file:
            content = file.read(_MOST_BYTES + 1)
        if len(content) > _MOST_BYTES:
            fault = f"has more than {_MOST_BYTES / 1e6:g} MB, which no such file needs; {again}"
            raise InputError(str(path), [fault])
        text = content.decode()
        return json.loads(
            text, parse_constant=_no_number, parse_float=_finite, parse_int=_countable
        )
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
    except (ValueError, RecursionError, MemoryError) as error:
        raise InputError(str(path), [f"cannot be read: {_damage(error)}; {again}"]) from None


def record(kind: type[Record], data: object, path: Path, *, more: bool = False) -> Record:
    """A record out of the plain values of a file.

    Args:
        kind: its type.
        data: the plain values.
        path: the file, for messages.
        more: whether they may hold what the record has no place for.

    Raises:
        InputError: they are none of it; says what is wrong, place by place.
    """
    try:
        found = of_plain(kind, data)
        unknown = [] if more else sorted(_unknown(data, plain(found)))
    except ValidationError as error:
        raise InputError(str(path), faults(error)) from None
    if unknown:
        listed = ", ".join(unknown[:_LISTED]) + (" …" if len(unknown) > _LISTED else "")
        fault = f"holds what is not known here: {listed}"
        raise InputError(str(path), [f"{fault}; a newer simcompare may have written it: update"])
    return found


def _unknown(data: object, known: object, place: str = "") -> Iterator[str]:
    """Names in plain values that a record has no place for."""
    if isinstance(data, dict) and isinstance(known, dict):
        for name, value in data.items():
            if name in known:
                yield from _unknown(value, known[name], f"{place}{name}.")
            else:
                yield place + name
    elif isinstance(data, list) and isinstance(known, list):
        for i, (one, other) in enumerate(zip(data, known, strict=False)):
            yield from _unknown(one, other, f"{place}{i}.")


def _damage(error: Exception) -> str:
    """What is wrong with a text that should be JSON."""
    if isinstance(error, json.JSONDecodeError):
        return f"it is cut off or damaged in line {error.lineno}"
    return str(error) if isinstance(error, _NoNumber) else "it is damaged"


class _NoNumber(ValueError):
    """What Python takes for a number, and we never write."""


def _no_number(constant: str) -> float:
    raise _NoNumber(f"{constant} is no number")


def _finite(text: str) -> float:
    value = float(text)
    return value if math.isfinite(value) else _no_number(text[:20])


def _countable(text: str) -> int:
    if len(text) > len(str(_LARGEST)) + 1 or abs(int(text)) > _LARGEST:
        raise _NoNumber(f"{text[:20]} … is too large a number")
    return int(text)
