"""A mapping file to be filled in, made from the columns that a log has."""

from __future__ import annotations

import json

from simcompare import units
from simcompare.hardware.conditioning.naming import slug
from simcompare.hardware.logs.raw import RawColumn, RawLog

#: what stands where the user must write
UNKNOWN = "?"


def of_log(raw: RawLog, name: str, kind: str) -> str:
    """The text of a mapping file with a line for every column.

    Args:
        raw: the log as it was read.
        name: of its file.
        kind: format by which it was read.
    """
    lines = [
        f"# How to read {name}: replace every {UNKNOWN}, delete what is not wanted.",
        f"format: {kind}",
    ]
    clocks = [stream for stream in raw.streams if stream.time is None and not stream.increment_s]
    if clocks:
        lines.append(f"time: {{column: {UNKNOWN}, unit: {UNKNOWN}}}   # or {{rate_Hz: {UNKNOWN}}}")
    columns: dict[str, RawColumn] = {}
    for stream in raw.streams:
        for column in stream.columns:
            if column.name != stream.time:
                columns.setdefault(column.name, column)
    lines.append("channels:")
    taken: set[str] = set()
    for column in columns.values():
        lines.append(f"  {_line(column, taken)}")
    return "\n".join(lines) + "\n"


def _line(column: RawColumn, taken: set[str]) -> str:
    stem = slug(column.name)
    unit = column.unit or (units.unit_of(column.name) if units.suffix_of(column.name) else UNKNOWN)
    stem = stem.removesuffix(units.suffix_of(stem)).lower() or "column"
    name = stem
    number = 2
    while name in taken:
        name, number = f"{stem}_{number}", number + 1
    taken.add(name)
    # JSON strings are YAML strings, whatever a column is called
    raw = json.dumps(column.name, ensure_ascii=False)
    return f"{name}: {{column: {raw}, unit: {json.dumps(unit, ensure_ascii=False)}}}"
