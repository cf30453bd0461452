"""Logs that say no units, but whose header says by which program or device they were written.

What such a source writes is data: one YAML file each in the folder ``sources``, with the page that
says so. The first table that fits is taken, and a note in the recording tells which.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, field_validator

from simcompare.hardware.raw import RawLog
from simcompare.model.recording import INFO, Repair

_FOLDER = Path(__file__).parent / "sources"
#: how far the length of a unit vector is from 1 as numbers are written, and rows that tell
_ROUNDED, _MIN_ROWS = 1e-3, 5
#: what stands for a unit that the lines above the header give
_SAID_ABOVE = "above"


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Evidence(_Part):
    """Where it stands that a source writes this.

    Attributes:
        address: of the page or file.
        seen: on which day.
        says: what it says, in short.
    """

    address: str
    seen: date
    says: str


class Quantity(_Part):
    """What a column holds.

    Attributes:
        unit: of its values; "above" where a line above the header gives the unit of lengths;
            empty where the numbers at rest tell it.
        kind: "specific_force" or "gravity_removed", for accelerations.
        frame: in which a component is given.
    """

    unit: str
    kind: Literal["", "specific_force", "gravity_removed"] = ""
    frame: str = ""


class TableOf(_Part):
    """One kind of table that a source writes. Names are regular expressions for whole names.

    Attributes:
        holds: in a few words.
        file: found in the name of the file.
        head: found in the lines above the header.
        columns: each of them is there.
        closed: whether no column may be there that is not listed among the channels.
        rows: the word that each row begins with, or has behind its stamp.
        missing: what stands in cells where nothing was measured.
        unnamed: names of all columns, for tables without a header.
        unit_vector: columns that together have the length 1 in each row, by which such a table is
            known.
        time: the column of the time; where it is not given it is found by its name.
        rate_Hz: finds the rate in the lines above the header, for tables without a time.
        length: finds the unit of lengths there.
        channels: name -> unit, or unit, kind and frame; the first name that fits.
    """

    holds: str
    file: str = ""
    head: str = ""
    columns: tuple[str, ...] = ()
    closed: bool = False
    rows: str = ""
    missing: tuple[str, ...] = ()
    unnamed: tuple[str, ...] = ()
    unit_vector: tuple[str, ...] = ()
    time: str = ""
    rate_Hz: str = ""
    length: str = ""
    channels: Mapping[str, Quantity] = Field(default_factory=dict)

    @field_validator("channels", mode="before")
    @classmethod
    def _units_alone(cls, given: Mapping[str, Any]) -> dict[str, Any]:
        return {k: {"unit": v} if isinstance(v, str) else v for k, v in given.items()}


class Robot(_Part):
    """A robot that is known by the names of its joints.

    Attributes:
        name: of the robot.
        known_by: joints that are all there.
        revolute: a regular expression for whole names of joints that turn.
        prismatic: the same for joints that slide.
    """

    name: str
    known_by: tuple[str, ...] = Field(min_length=2)
    revolute: str = ""
    prismatic: str = ""


class Source(_Part):
    """A program or device.

    Attributes:
        title: its name.
        evidence: where its units are stated.
        tables: what it writes.
        robots: whose joints it describes.
    """

    title: str
    evidence: tuple[Evidence, ...] = Field(min_length=1)
    tables: tuple[TableOf, ...] = ()
    robots: tuple[Robot, ...] = ()


@dataclass(frozen=True)
class Found:
    """A table that was recognised.

    Attributes:
        title: of its source.
        table: how it is to be read.
        names: of its columns, with their units.
        rate_Hz: samples in a second, where a line above the header says it.
    """

    title: str
    table: TableOf
    names: tuple[tuple[str, str], ...]
    rate_Hz: float | None = None

    def finish(self, log: RawLog) -> None:
        """Says what the columns are, and tells what was recognised."""
        for column in (column for stream in log.streams for column in stream.columns):
            meant = _quantity(self.table, column.name)
            if meant is not None:
                column.defined = True
                column.kind, column.frame = column.kind or meant.kind, column.frame or meant.frame
        text = f"recognised as {self.title} ({self.table.holds}), which defines the units"
        log.repairs.append(Repair("source", INFO, text))


@functools.cache
def sources() -> Mapping[str, Source]:
    """All known sources by the names of their files."""
    return {
        path.stem: Source.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")))
        for path in sorted(_FOLDER.glob("*.yaml"))
    }


def find(
    file: str, above: Sequence[str], names: Sequence[tuple[str, str]], word: str = ""
) -> Found | None:
    """The first table of a source that fits to a log.

    Args:
        file: its name.
        above: lines above its header.
        names: of its columns, with the units that the log itself says.
        word: that stands in each of its rows, empty for the most.
    """
    text = "\n".join(above)
    for source in sources().values():
        for table in source.tables:
            if table.rows == word and _fits(table, file, text, [name for name, _ in names]):
                return _found(source.title, table, text, names)
    return None


def settle(log: RawLog, file: str) -> None:
    """Gives the columns of each stream the units that their source defines, where it is known.

    Args:
        log: of a format that has no lines above a header.
        file: its name.
    """
    for stream in log.streams:
        found = find(file, (), [(column.name, column.unit) for column in stream.columns])
        if found is not None:
            for column, (_, unit) in zip(stream.columns, found.names, strict=True):
                column.unit = unit
            found.finish(RawLog([stream], repairs=log.repairs))


def robot(joints: Collection[str]) -> Robot | None:
    """The first robot all of whose telling joints are among these names."""
    known = (robot for source in sources().values() for robot in source.robots)
    return next((robot for robot in known if {*robot.known_by} <= {*joints}), None)


def words() -> frozenset[str]:
    """What the rows of tables begin with that are known by it."""
    return frozenset(table.rows for source in sources().values() for table in source.tables) - {""}


def name(rows: Sequence[Sequence[float]], word: str = "") -> tuple[str, ...]:
    """Names of the columns of a table without a header, where its numbers tell whose it is.

    Args:
        rows: the first ones.
        word: that stands in each of them.
    """
    tables = [table for source in sources().values() for table in source.tables if table.unnamed]
    fitting = (
        t for t in tables
        if t.rows == word and len(rows) >= _MIN_ROWS and all(_unit(t, row) for row in rows)
    )  # fmt: skip
    return next((table.unnamed for table in fitting), ())


def _unit(table: TableOf, row: Sequence[float]) -> bool:
    if len(row) != len(table.unnamed) or not table.unit_vector:
        return len(row) == len(table.unnamed) and bool(table.rows)
    values = dict(zip(table.unnamed, row, strict=True))
    return abs(math.hypot(*(values[part] for part in table.unit_vector)) - 1) < _ROUNDED


def _fits(table: TableOf, file: str, text: str, names: Sequence[str]) -> bool:
    named = not table.unnamed or [*table.unnamed] == [*names]
    return (
        named
        and bool(re.search(table.file, file, re.IGNORECASE))
        and bool(re.search(table.head, text))
        and all(any(re.fullmatch(wanted, name) for name in names) for wanted in table.columns)
        and not (table.closed and any(_quantity(table, name) is None for name in names))
    )


def _found(title: str, table: TableOf, text: str, names: Sequence[tuple[str, str]]) -> Found:
    length, rate = (_said(pattern, text) for pattern in (table.length, table.rate_Hz))
    quantities = {
        name: quantity
        for name, unit in names
        for quantity in [_quantity(table, name)]
        if quantity is not None and not unit
    }
    of = {_SAID_ABOVE: length}
    full = tuple(
        (name, of.get(quantities[name].unit, quantities[name].unit) if name in quantities else unit)
        for name, unit in names
    )
    return Found(title, table, full, _positive(rate))


def _quantity(table: TableOf, name: str) -> Quantity | None:
    return next((q for known, q in table.channels.items() if re.fullmatch(known, name)), None)


def _said(pattern: str, text: str) -> str:
    match = re.search(pattern, text, re.MULTILINE) if pattern else None
    return match[1] if match else ""


def _positive(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if 0 < value < 1e9 else None
