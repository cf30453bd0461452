"""A mapping file to be filled in, made from the columns that a log has."""

from __future__ import annotations

import json

from simcompare import units
from simcompare.hardware.conditioning.units.naming import slug
from simcompare.hardware.mapping import UNKNOWN
from simcompare.hardware.raw import RawColumn, RawLog


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
    lines += _time(raw)
    columns: dict[str, RawColumn] = {}
    for stream in raw.streams:
        for column in stream.columns:
            if column.name != stream.time:
                columns.setdefault(column.name, column)
    joints = dict.fromkeys(c.joint for c in columns.values() if c.joint and not c.unit)
    if joints:
        each = ", ".join(f"{_quoted(name)}: {_quoted(UNKNOWN)}" for name in joints)
        lines.append(f"joints: {{{each}}}   # revolute (it turns) or prismatic (it slides)")
    taken: set[str] = set()
    others = [c for c in columns.values() if c.unit or not c.joint]
    lines += ["channels:"] if others else []
    for column in others:
        lines.append(f"  {_line(column, taken)}")
    return "\n".join(lines) + "\n"


def _time(raw: RawLog) -> list[str]:
    """A line for the clock, where the log does not say all of it."""
    if any(stream.time is None and not stream.increment_s for stream in raw.streams):
        unknown = _quoted(UNKNOWN)
        return [f"time: {{column: {unknown}, unit: {unknown}}}   # or {{rate_Hz: 100}}"]
    clocks = [stream.column(stream.time) for stream in raw.streams if stream.time is not None]
    unclear = [c for c in clocks if not c.unit and units.unit_of(c.name) != "s"]
    if not unclear:
        return []
    names = list(dict.fromkeys(column.name for column in clocks))
    shown = _quoted(names[0]) if len(names) == 1 else f"[{', '.join(map(_quoted, names))}]"
    return [f"time: {{column: {shown}, unit: {_quoted(UNKNOWN)}}}"]


def _line(column: RawColumn, taken: set[str]) -> str:
    stem = slug(column.name)
    unit = column.unit or (units.unit_of(column.name) if units.suffix_of(column.name) else UNKNOWN)
    stem = stem.removesuffix(units.suffix_of(stem)).lower() or "column"
    name = stem
    number = 2
    while name in taken:
        name, number = f"{stem}_{number}", number + 1
    taken.add(name)
    return f"{name}: {{column: {_quoted(column.name)}, unit: {_quoted(unit)}}}"


def _quoted(text: str) -> str:
    """A YAML string, whatever it holds: JSON strings are such."""
    return json.dumps(text, ensure_ascii=False)
