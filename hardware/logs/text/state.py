"""What comes of a text table: its columns, and what was noticed while they were read."""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.raw import MAX_ROWS, RawColumn
from simcompare.model.recording import INFO, REPAIR, Repair, ranges

#: faults that are named one by one
MAX_FAULTS = 20


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


class Lines:
    """Numbers of lines that increase, as stretches: there may be millions."""

    def __init__(self) -> None:
        self._ends = array("q")
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def add(self, line: int) -> None:
        """Adds one."""
        self._count += 1
        if self._ends and self._ends[-1] == line - 1:
            self._ends[-1] = line
        else:
            self._ends.extend((line, line))

    def runs(self) -> NDArray[np.int64]:
        """First and last line of each stretch (k, 2)."""
        return np.array(self._ends, dtype=np.int64).reshape(-1, 2)


@dataclass
class Faults:
    """Faults of one file; the first ones are named, the others counted."""

    where: str
    texts: list[str] = field(default_factory=list)
    count: int = 0

    def add(self, text: str) -> None:
        """Adds one."""
        self.count += 1
        if self.count <= MAX_FAULTS:
            self.texts.append(text)

    def finish(self, more: str = "") -> None:
        """Raises them, where there are any; ``more`` stands before the number of the others."""
        if self.count > len(self.texts):
            self.texts.append(f"and {more}{self.count - len(self.texts)} more such faults")
        if self.texts:
            raise InputError(self.where, self.texts)


@dataclass
class State:
    """What is known after the blocks that were read so far."""

    lengths: dict[int, int] = field(default_factory=dict)
    origins: dict[int, int] = field(default_factory=dict)
    clock_ns: dict[int, int] = field(default_factory=dict)
    period_ns: int = 0
    midnights: list[int] = field(default_factory=list)
    days: set[int] = field(default_factory=set)
    skipped: dict[str, Lines] = field(default_factory=dict)
    truncated: str = ""
    no_end: int = 0
    examples: dict[int, str] = field(default_factory=dict)

    def skip(self, reason: str, line: int) -> None:
        """Notes a line that is no row."""
        self.skipped.setdefault(reason, Lines()).add(line)

    def rows(self, first: int, count: int) -> NDArray[np.int64] | None:
        """Lines of all rows, ``None`` where they follow each other from the first on."""
        skipped_runs = [lines.runs() for lines in self.skipped.values()]
        runs = np.concatenate([np.empty((0, 2), dtype=np.int64), *skipped_runs])
        runs = runs[np.argsort(runs[:, 0])]
        lengths = runs[:, 1] - runs[:, 0] + 1
        # the row, counted from 0, before which each stretch of other lines stands
        places = runs[:, 0] - first - (np.cumsum(lengths) - lengths)
        if not (places < count).any():
            return None
        step = np.zeros(count + 1, dtype=np.int64)
        np.add.at(step, np.minimum(places, count), lengths)
        step += 1
        step[0] += first - 1
        return np.cumsum(step)[:count]

    def repairs(self, layout: Layout) -> list[Repair]:
        """What was noticed on the way."""
        noticed = []
        if layout.decimal == ",":
            noticed.append(
                Repair("decimal_comma", INFO, "numbers are written with a decimal comma")
            )
        if layout.thousands:
            text = f"{layout.thousands!r} separates thousands and was taken out"
            noticed.append(Repair("thousands", INFO, text))
        words = {
            "blank_line": (INFO, "empty lines were passed over"),
            "comment_line": (INFO, "remarks between the rows were passed over"),
            "nmea_line": (INFO, "sentences of a GPS (NMEA) between the rows were left out"),
            "remark_line": (REPAIR, "lines of words, without numbers, were passed over"),
            "ragged_row": (REPAIR, "rows with more or fewer cells than the others were left out"),
            "header_repeated": (REPAIR, "the header stands again between the rows; left out"),
        }
        for rule, lines in self.skipped.items():
            if rule in words:
                severity, text = words[rule]
                named = tuple((a, b) for a, b in lines.runs()[:MAX_ROWS].tolist())
                noticed.append(Repair(rule, severity, text, rows=named, count=len(lines)))
        if self.no_end:
            text = (
                f"line {self.no_end}, the last one, has no line end; if the file was cut there, its"
                " last number is not whole"
            )
            noticed.append(
                Repair("no_line_end", INFO, text, rows=((self.no_end, self.no_end),), count=1)
            )
        if self.midnights:
            hour = self.period_ns == 3600 * 10**9
            text = "the minutes pass the hour; an hour was added from there on" if hour else (
                "the time of day passes midnight; a day was added from there on"
            )  # fmt: skip
            rows = ranges(self.midnights[:MAX_ROWS])
            noticed.append(Repair("midnight", REPAIR, text, rows=rows, count=len(self.midnights)))
        return noticed
