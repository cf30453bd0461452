"""Typed records as the plain values of JSON, and back.

JSON has no number that is not finite: a field of the type :data:`Finite` is ``null`` there, and NaN
in the record that is read back.
"""

from __future__ import annotations

import json
import math
from functools import cache
from typing import Annotated, Any, TypeAlias, TypeVar, cast

from pydantic import BeforeValidator, PlainSerializer, TypeAdapter, ValidationError

Record = TypeVar("Record")
#: an object of JSON or a mapping of YAML, where it is read or written: it may hold anything
Plain: TypeAlias = dict[str, Any]


#: faults of a record that are listed
_MAX_FAULTS = 5


def _or_nan(value: object) -> object:
    return math.nan if value is None else value


def _or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None


#: a number that may be none: NaN, or without a limit
Finite = Annotated[float, BeforeValidator(_or_nan), PlainSerializer(_or_none)]


def plain(record: object) -> Plain:
    """A record, or any part of one, as JSON holds it."""
    found: Plain = _adapter(cast("Any", type(record))).dump_python(
        record, mode="json", by_alias=True
    )
    return found


def text(record: object, indent: int | None = None) -> str:
    """JSON of a record; a number that is not finite is an error, not ``NaN``.

    A byte of a file's name that is not UTF-8 is written as an escape of JSON.
    """
    found = json.dumps(plain(record), indent=indent, ensure_ascii=False, allow_nan=False)
    return found.encode("utf-8", "backslashreplace").decode("utf-8")


def of_plain(kind: type[Record], data: object) -> Record:
    """A record out of plain values.

    Raises:
        ValueError: they are none of it.
    """
    found: Record = _adapter(cast("Any", kind)).validate_python(data)
    return found


def faults(error: ValidationError) -> list[str]:
    """What is wrong in JSON, with its place, the first few of it."""
    found = [
        f"cannot be read: {'.'.join(map(str, fault['loc']))}: {fault['msg'].lower()}"
        for fault in error.errors()[:_MAX_FAULTS]
    ]
    more = error.error_count() - len(found)
    return [*found, f"{more} more such faults"] if more else found


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:  # noqa: ANN401
    return TypeAdapter(kind)
