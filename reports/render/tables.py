"""Tables as plain values, for HTML, Markdown, PDF and the terminal alike."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from simcompare import notation
from simcompare.reports.render import numbers

_POWERS = (-3, 6)
#: more decimals than these are noise to a reader
_MAX_PLACES = 7


class Column(NamedTuple):
    """Head of a column.

    Attributes:
        head: what is in it, with its unit where all rows share one.
        text: whether it holds words, which begin at the left, and not numbers.
        spare: whether it is left out on paper, where there is little room.
        nowrap: whether its words, such as a name or a unit, stay on one line.
        over: a head that it shares with the columns beside it, empty for none.
    """

    head: str
    text: bool = False
    spare: bool = False
    nowrap: bool = False
    over: str = ""

    @property
    def full_head(self) -> str:
        """Both heads on one line."""
        return ", ".join(filter(None, (self.over, self.head)))


class Group(NamedTuple):
    """Rows that belong together.

    Attributes:
        title: what they share, empty for nothing.
        rows: of cells, one for each column.
        note: what is said of what they share, behind the title.
    """

    title: str
    rows: tuple[tuple[str, ...], ...]
    note: str = ""

    @property
    def head(self) -> str:
        """Title and note on one line."""
        return ": ".join(filter(None, (self.title, self.note)))


class Table(NamedTuple):
    """A table.

    Attributes:
        title: above it, empty for none.
        columns: from left to right.
        groups: of rows.
        note: what the reader must know of it.
        folded: whether it is only wanted by few readers.
        engines: whether the first column holds engines.
    """

    title: str
    columns: tuple[Column, ...]
    groups: tuple[Group, ...]
    note: str = ""
    folded: bool = False
    engines: bool = False

    @property
    def overs(self) -> list[tuple[str, int]]:
        """Heads over the heads, each with the number of its columns; none where all are empty."""
        overs = itertools.groupby(column.over for column in self.columns)
        heads = [(over, len(list(columns))) for over, columns in overs]
        return heads if any(over for over, _ in heads) else []

    def narrow(self) -> Table:
        """The same without the columns that can be spared."""
        return self.kept([i for i, column in enumerate(self.columns) if not column.spare])

    def without(self, heads: Sequence[str]) -> Table:
        """The same without the columns with these heads."""
        return self.kept([i for i, column in enumerate(self.columns) if column.head not in heads])

    def kept(self, keep: Sequence[int]) -> Table:
        """The same with some columns alone."""
        groups = tuple(
            group._replace(rows=tuple(tuple(row[i] for i in keep) for row in group.rows))
            for group in self.groups
        )
        return self._replace(columns=tuple(self.columns[i] for i in keep), groups=groups)


class Scale(NamedTuple):
    """How the numbers of one quantity are written so that their points stand below each other.

    Attributes:
        power: of ten, which stands in the head.
        places: digits after the point.
    """

    power: int
    places: int

    def text(self, value: float | None) -> str:
        """A number; a dash where there is none."""
        if value is None or not math.isfinite(value):
            return "–"
        return notation.fixed(value / 10.0**self.power, self.places)

    def unit(self, unit: str) -> str:
        """Unit in brackets, with the power of ten where there is one."""
        known = "" if unit in ("", "1") else unit
        if self.power:
            known = f"10{numbers.raised(self.power)} {known}".strip()
        return f" ({known})" if known else ""


def scale_of(values: Iterable[float | None], digits: int = 3) -> Scale:
    """The scale on which the smallest of some sizes still has so many digits.

    Args:
        values: the sizes that matter; others may be written on the same scale.
        digits: of the smallest one, as far as a reader can bear it.
    """
    sizes = [abs(v) for v in values if v is not None and math.isfinite(v) and v != 0]
    if not sizes:
        return Scale(0, 0)
    top, low = (math.floor(math.log10(size)) for size in (max(sizes), min(sizes)))
    power = 0 if _POWERS[0] <= top < _POWERS[1] else 3 * math.floor(top / 3)
    places = digits - 1 - (low - power)
    return Scale(power, min(max(places, 0), _MAX_PLACES))


def of_engines(
    columns: Sequence[Column], groups: Iterable[Group], note: str = "", title: str = ""
) -> Table:
    """A table with engines as rows."""
    return Table(title, (Column("Engine", text=True), *columns), tuple(groups), note, engines=True)


def printable(text: str) -> str:
    """Text on one line without control characters; names come from files."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())
