"""What comes of a text table: its columns, and what was noticed while they were read."""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simcompare.hardware.logs._sniff import Layout
from simcompare.hardware.logs.raw import RawColumn
from simcompare.recording import INFO, REPAIR, Repair, ranges

#: faults that are named one by one
MOST_FAULTS = 20
#: rows of one kind that are named; their count is always whole
MOST_ROWS = 100_000


@dataclass
class Table:
    """The rows of a table.

    Attributes:
        columns: what holds numbers; dates and whole numbers of time as seconds or counts since
            their first value.
        first_row: line of the first row.
        rows: lines of all rows, where they do not simply follow each other.
        truncated: what is missing at the end.
        repairs: what was noticed or changed.
        ignored: columns that were left out, with the reason.
        origins: column -> its first value, for dates in nanoseconds since 1970.
    """

    columns: list[RawColumn]
    first_row: int
    rows: NDArray[np.int64] | None
    truncated: str
    repairs: list[Repair]
    ignored: dict[str, str]
    origins: dict[str, int]

    def __len__(self) -> int:
        return len(self.columns[0].values) if self.columns else 0


@dataclass
class State:
    """What is known after the blocks that were read so far."""

    lengths: dict[int, int] = field(default_factory=dict)
    origins: dict[int, int] = field(default_factory=dict)
    clock_ns: dict[int, int] = field(default_factory=dict)
    midnights: list[int] = field(default_factory=list)
    days: set[int] = field(default_factory=set)
    skipped: dict[str, array[int]] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    count: int = 0
    last_line: int = 0
    truncated: str = ""
    examples: dict[int, str] = field(default_factory=dict)

    def fault(self, text: str) -> None:
        """Counts a fault; the first ones are named."""
        self.count += 1
        if len(self.faults) < MOST_FAULTS:
            self.faults.append(text)

    def skip(self, reason: str, line: int) -> None:
        """Notes a line that is no row; eight bytes each, as there may be millions."""
        self.skipped.setdefault(reason, array("q")).append(line)

    def repairs(self, layout: Layout) -> list[Repair]:
        """What was noticed on the way."""
        found = []
        if layout.decimal == ",":
            found.append(Repair("decimal_comma", INFO, "numbers are written with a decimal comma"))
        if layout.thousands:
            text = f"{layout.thousands!r} separates thousands and was taken out"
            found.append(Repair("thousands", INFO, text))
        words = {
            "blank_line": (INFO, "empty lines were passed over"),
            "comment_line": (INFO, "remarks between the rows were passed over"),
            "header_repeated": (REPAIR, "the header stands again between the rows; left out"),
        }
        for rule, lines in self.skipped.items():
            if rule in words:
                severity, text = words[rule]
                named = ranges(np.asarray(lines[:MOST_ROWS]))
                found.append(Repair(rule, severity, text, rows=named, count=len(lines)))
        if self.midnights:
            text = "the time of day passes midnight; a day was added from there on"
            rows = ranges(self.midnights[:MOST_ROWS])
            found.append(Repair("midnight", REPAIR, text, rows=rows, count=len(self.midnights)))
        return found
