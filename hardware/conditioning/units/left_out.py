"""Columns that became no channel: why, and the line of a mapping file that keeps them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import yaml

from simcompare import units
from simcompare.hardware.mapping import PRISMATIC, REVOLUTE
from simcompare.hardware.mapping_lines import quoted, unit_text
from simcompare.hardware.raw import IMPORT, RawColumn
from simcompare.model.recording import Conversion

#: columns of one reason that are named
_SHOWN = 8
#: of more columns, where a template is the better way
_BESIDE_TEMPLATE = 3
UNKNOWN = "no unit is known"
_JOINT = (
    "a joint turns (rad) or slides (m), and the log does not say which; write"
    f" {REVOLUTE} or {PRISMATIC}"
)
PLAIN = "unit: 1}"
_TEMPLATE = (
    f"{IMPORT} --template > map.yaml writes a mapping file with a line for each: put the units in"
    " and give it with --map"
)


def left_out(column: RawColumn, name: str, reason: str, unit: str) -> Conversion:
    """The record of a column that becomes no channel.

    Args:
        column: the column.
        name: what its channel would be called, without unit.
        reason: why, as a half sentence.
        unit: the one that is proposed.
    """
    if column.joint and not column.unit:
        line = f"joints: {{{quoted(column.joint)}: {REVOLUTE}}}"
        return Conversion(column.name, "", "", "", reason=_JOINT, cure=line)
    stem = (name.removesuffix(units.suffix_of(name)) or name).lower()
    column_, unit_ = quoted(column.name), unit_text(unit)
    cure = f"channels: {{{stem}: {{column: {column_}, unit: {unit_}}}}}"
    return Conversion(column.name, column.unit, "", "", reason=reason, cure=cure)


def told(conversions: Iterable[Conversion]) -> list[str]:
    """A sentence for each reason, with the line that keeps all of its columns."""
    reasons: dict[str, dict[str, str]] = {}
    for one in conversions:
        if not one.channel:
            reasons.setdefault(one.reason, {}).setdefault(one.raw, one.cure)
    return [_told(reason, columns) for reason, columns in reasons.items()]


def refused(conversions: Iterable[Conversion]) -> list[str]:
    """The same, where they refuse the log."""
    cures = [one for one in conversions if one.cure]
    many = sum(one.cure.startswith("channels") for one in cures) > 1
    return told(cures) + ([_TEMPLATE] if many else [])


#: what a fault says to write into a mapping file about the time
_TIME_LINE = re.compile(r'time: \{(?:[^{}"]|"(?:\\.|[^"\\])*")*\}(?=(?: \(\w+\))?$)')


def with_channels(fault: str, conversions: Iterable[Conversion]) -> str:
    """A fault of the time, so that its line opens a log in which no unit is known.

    Args:
        fault: its text.
        conversions: of all columns of the stream.
    """
    line = _TIME_LINE.search(fault)
    if line is None:
        return fault
    try:
        time = yaml.safe_load(line[0])["time"].get("column")
    except yaml.YAMLError:  # a name that YAML cannot hold, such as one with a null byte
        return fault
    others = [one for one in conversions if one.raw != time]
    cures = list(dict.fromkeys(one.cure for one in others if one.cure.startswith("channels")))
    if not cures or any(one.channel for one in others):
        return fault
    many = len(cures) > _SHOWN
    shown = cures[:_BESIDE_TEMPLATE] if many else cures
    more = f"; {_TEMPLATE}; for the first {_BESIDE_TEMPLATE}" if many else ""
    head = fault[: line.start()].rstrip(": ") + fault[line.end() :]
    plain = "where no unit is known, unit: 1 keeps a plain number"
    return f"{head}; {plain}{more}: {{{line[0]}, {_joined(shown)}}}"


def _told(reason: str, columns: dict[str, str]) -> str:
    shown = ", ".join(map(repr, [*columns][:_SHOWN])) + (" …" if len(columns) > _SHOWN else "")
    cures = [cure for cure in dict.fromkeys(columns.values()) if cure]
    if not cures:
        return f"{shown}: {reason}"
    plain = " as a plain number, or with the unit that you write" if PLAIN in cures[0] else ""
    them = "it" if len(columns) == 1 else "them"
    them = f"the first {_SHOWN}" if len(cures) > _SHOWN else them
    return (
        f"{shown}: {reason}. This line in a mapping file (--map) keeps {them}{plain}"
        f"; cure: {_joined(cures[:_SHOWN])}"
    )


def _joined(cures: Sequence[str]) -> str:
    """One line of YAML that says all of them."""
    parts: dict[str, list[str]] = {}
    for cure in cures:
        key, _, inner = cure.partition(": {")
        parts.setdefault(key, []).append(inner.removesuffix("}"))
    return ", ".join(f"{key}: {{{', '.join(inner)}}}" for key, inner in parts.items())
