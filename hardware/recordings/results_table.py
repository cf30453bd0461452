"""Tables of results as text: a row of headings, and one experiment in each row below it."""

from __future__ import annotations

import hashlib
import io
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import sniff
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text import table as _table
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.mapping import NOTHING
from simcompare.hardware.mapping import Mapping as ColumnMap
from simcompare.model.trajectory import Array
from simcompare.units import endings

#: a table has no more rows than somebody measured by hand
MAX_ROWS = 200
#: bytes of the largest file that is read as one
_MAX_BYTES = 1 << 20
#: l/cm may be centimetres and not litres over centimetres
_TOLD_APART = re.compile(r" #\d+$")
_OVER = re.compile(r"(.*\S)\s*/\s*\(?([^/()]+(?:/[^/()]+)?)\)?")


@dataclass(frozen=True)
class Heading:
    """What stands above a column.

    Attributes:
        name: without its unit; told apart from others that are written alike.
        unit: as it is written, empty where nothing is said.
        number: of the column, first is 1.
        holds_numbers: whether numbers stand below it.
        scale: what its numbers are multiplied by to be in the unit, where a mapping file says so.
    """

    name: str
    unit: str
    number: int
    holds_numbers: bool = True
    scale: float = 1.0

    @property
    def plain(self) -> str:
        """The name as it is written, also where another column is called alike."""
        return _TOLD_APART.sub("", self.name)

    @property
    def text(self) -> str:
        """Name and unit as they are written."""
        return f"{self.plain} ({self.unit})" if self.unit else self.plain


@dataclass(frozen=True)
class ResultsTable:
    """A table that has been read.

    Attributes:
        label: the file.
        sha256: of the file.
        headings: of all columns.
        values: number of a column -> its numbers (n,), NaN for an empty cell.
        lines: line of each row (n,).
        about: what stands above the table, as ``key: value``.
        remarks: what was noticed while it was read.
    """

    label: str
    sha256: str
    headings: tuple[Heading, ...]
    values: Mapping[int, Array]
    lines: NDArray[np.int64]
    about: Mapping[str, str]
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class Opened:
    """A table whose headings have been read.

    Attributes:
        source: its text.
        layout: how it is written.
        headings: of all columns.
        rows: about how many rows it has, as far as its beginning tells.
        sha256: of the file.
    """

    source: _source.Source
    layout: Layout
    headings: tuple[Heading, ...]
    rows: int
    sha256: str

    @property
    def about(self) -> dict[str, str]:
        """What stands above the table."""
        return _cell.about_of(self.layout.preamble)


def opened(path: Path, mapping: ColumnMap = NOTHING) -> Opened:
    """The headings of a table.

    Args:
        path: the file.
        mapping: says of columns what they hold, by the names of the scenario.

    Raises:
        InputError: it is no table of text, or lacks a column that the mapping names.
    """
    source = _source.source_of(path)
    layout = sniff.sniff(source)
    numbers = ("number", "flag")
    headings = tuple(
        Heading(*_named(name, unit), k + 1, kind in numbers)
        for k, ((name, unit), kind) in enumerate(zip(layout.names, layout.kinds, strict=True))
    )
    rows = len([line for line in source.head[layout.first_line - 1 :] if line.strip()])
    raw = path.read_bytes() if source.complete else b""
    headings = _mapped(headings, mapping, source.label)
    return Opened(_ended(source, raw), layout, headings, rows, hashlib.sha256(raw).hexdigest())


def _mapped(headings: tuple[Heading, ...], mapping: ColumnMap, label: str) -> tuple[Heading, ...]:
    """Headings as a mapping says them; several columns of one channel are repeats."""
    made = {heading.name: heading for heading in headings}
    faults = []
    for name, channel in mapping.channels.items():
        for number, column in enumerate(channel.columns, start=1):
            if column not in made:
                faults.append(str(UnknownName("column", column, [one.name for one in headings])))
                continue
            plain = name.removesuffix(units.suffix_of(name))
            called = f"{plain} {number}" if len(channel.columns) > 1 else plain
            made[column] = replace(made[column], name=called, unit=channel.unit,
                                   scale=channel.sign * channel.scale)  # fmt: skip
    if faults:
        raise InputError(label, faults)
    return tuple(made[heading.name] for heading in headings)


def read(table: Opened, wanted: Collection[int]) -> ResultsTable:
    """The numbers of a table.

    Args:
        table: the table.
        wanted: numbers of the columns that are used; what stands in others never blocks.

    Raises:
        InputError: it has too many rows, or rows that cannot be read.
    """
    label = table.source.label
    if not table.source.complete or table.rows > MAX_ROWS:
        about = "" if table.source.complete else "more than "
        raise InputError(
            label,
            [f"has {about}{table.rows} rows; a table of results has at most {MAX_ROWS}, one for"
             " each experiment. A log of samples needs a column of time"],
        )  # fmt: skip
    spare = {name for k, (name, _) in enumerate(table.layout.names) if k + 1 not in wanted}
    made = _table.read(table.source, table.layout, spare=spare)
    numbers = {name: k + 1 for k, (name, _) in enumerate(table.layout.names)}
    count = len(made)
    lines = np.arange(made.first_row, made.first_row + count) if made.rows is None else made.rows
    remarks = [repair.text for repair in (*table.source.repairs, *made.repairs)]
    values = {
        numbers[column.name]: np.asarray(column.values, dtype=float)
        for column in made.columns
        if column.name in numbers and np.ndim(column.values) == 1
    }
    return ResultsTable(
        label, table.sha256, table.headings, values, np.asarray(lines)[:count], table.about,
        (*remarks, *filter(None, [made.truncated])),
    )  # fmt: skip


def _named(name: str, unit: str) -> tuple[str, str]:
    """Name and unit of a heading, also where the unit ends the name."""
    match = None if unit else _OVER.fullmatch(name)
    if match and units.is_written(match[2].strip()):
        return match[1], match[2].strip()
    suffix = "" if unit else units.suffix_of(name)
    if suffix and name.removesuffix(suffix) and not endings.is_several(name, suffix):
        return name.removesuffix(suffix), units.UNITS_BY_SUFFIX[suffix]
    return name, unit


def _ended(source: _source.Source, raw: bytes) -> _source.Source:
    """The same text with an end of its last line: a table that was typed is not cut."""
    if not source.complete or (source.head and not source.head[-1]):
        return source
    whole = raw + "\n".encode(source.encoding)
    return replace(source, open=lambda: io.BytesIO(whole), head=(*source.head, ""))
