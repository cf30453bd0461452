"""Records as JSON: written from their types, and read back into them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Any, cast

from pydantic import Field, TypeAdapter, ValidationError

from simcompare.errors import InputError
from simcompare.model.settings import OLD_LEVELS
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.run import FORMAT, Record, RunRecord
from simcompare.results.records.validation import ValidationRecord

#: the first format, of version 0.1, named no kind
_FIRST_FORMAT = 1
_MOST_FAULTS = 5

AnyRecord = Annotated[RunRecord | FitRecord | ValidationRecord, Field(discriminator="kind")]


def plain(record: Any) -> dict[str, Any]:  # noqa: ANN401
    """A record, or any part of one, as JSON holds it."""
    adapter = _adapter(cast("Any", type(record)))
    found: dict[str, Any] = adapter.dump_python(record, mode="json", by_alias=True)
    return found


def text(record: Any, indent: int | None = None) -> str:  # noqa: ANN401
    """JSON of a record; a number that is not finite is an error, not ``NaN``."""
    return json.dumps(plain(record), indent=indent, ensure_ascii=False, allow_nan=False)


def read(path: Path) -> Record:
    """The record of a run, a fit or a validation.

    Raises:
        InputError: it cannot be read; says where it is damaged.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(str(path), [f"cannot be read: {error}"]) from None
    try:
        return of_plain(data)
    except InputError as error:
        raise InputError(str(path), error.faults) from None


def of_plain(data: object) -> Record:
    """The record that JSON holds, also that of an older format.

    Raises:
        InputError: it is none; says what is wrong, place by place.
    """
    if not isinstance(data, dict):
        raise InputError("record", [f"holds a {type(data).__name__}, not an object"])
    known = (_FIRST_FORMAT, FORMAT)
    if data.get("format") not in known:
        expected = " or ".join(map(str, known))
        fault = f"format {data.get('format')!r} is not known; expected {expected}"
        raise InputError("record", [fault])
    try:
        found: Record = _adapter(AnyRecord).validate_python(_of_today(data))
    except ValidationError as error:
        raise InputError("record", [f"cannot be read: {one}" for one in faults(error)]) from None
    return found


def faults(error: ValidationError) -> list[str]:
    """What is wrong in JSON, with its place, the first few of it."""
    found = [
        f"{'.'.join(str(part) for part in fault['loc'][1:])}: {fault['msg'].lower()}"
        for fault in error.errors()[:_MOST_FAULTS]
    ]
    more = error.error_count() - len(found)
    return [*found, f"and {more} more"] if more else found


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:  # noqa: ANN401
    return TypeAdapter(kind)


def _of_today(data: Mapping[str, Any]) -> dict[str, Any]:
    """What an older version stored, under the names of today."""
    if data["format"] == FORMAT:
        return dict(data)
    kind = next((name for name in ("fit", "validation") if data.get(name)), "run")
    rows = [dict(row) for row in data.get("scores", ()) if isinstance(row, Mapping)]
    for row in rows:  # what was called u is the scatter of single repeats
        row.setdefault("scatter", row.get("u") if kind == "run" else None)
        if kind == "run" and row["scatter"] is not None:
            row["u"] = row["scatter"] / math.sqrt(max(row.get("repeats") or 1, 1))
    sources = [dict(row) for row in data.get("sources", ()) if isinstance(row, Mapping)]
    for row in (*rows, *sources):
        row["contact"] = OLD_LEVELS.get(row.get("contact", ""), row.get("contact"))
    return {**data, "format": FORMAT, "kind": kind, "scores": rows, "sources": sources}
