"""What an importer reads: columns as the log has them, before anything is converted or repaired.

Columns are changed in place, by rules that look at neighbours and carry counts along. As queries on
a table that DuckDB keeps, these rules would be longer, so long columns lie in unnamed files.
"""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from simcompare.model.recording import Clock, Event, Repair
from simcompare.model.trajectory import Array

#: how a message begins a command for the log; LOG becomes its path
IMPORT = "simcompare import LOG"
#: samples that are looked at together where all columns of a stream are
BLOCK = 1 << 18
#: rows of one defect that are named; their count is always whole
MAX_ROWS = 100_000
#: values of a stream that are kept in memory; what is more goes into a temporary file
SPILL = 1 << 22


def blocks(count: int) -> Iterator[slice]:
    """Slices that cover ``count`` samples, each of at most ``BLOCK``."""
    for start in range(0, count, BLOCK):
        yield slice(start, min(start + BLOCK, count))


def told_apart(names: Iterable[str]) -> list[str]:
    """The names, each of them once: what stands again is ``t #2``, ``t #3``."""
    made: dict[str, None] = {}  # in order, each once
    alike: Counter[str] = Counter()
    for name in names:
        free, number = name, alike[name]
        while free in made:
            number += 1
            free = f"{name} #{number}"
        made[free] = None
        # "t #2" is one more that is called so, and one more that is called "t"
        parts = free.split(" #")
        alike.update(" #".join(parts[: i + 1]) for i in range(min(len(parts), 10)))
    return [*made]


def room(count: int) -> Array:
    """A writable array (n,); long ones lie in an unnamed file, not in memory."""
    if count <= SPILL:
        return np.empty(count)
    file = tempfile.TemporaryFile()  # noqa: SIM115  (it vanishes with the array that looks into it)
    file.truncate(8 * count)
    return np.memmap(file, dtype=np.float64, mode="r+", shape=(count,))


@dataclass
class RawColumn:
    """One column of a log.

    Attributes:
        name: as the log has it, without its unit.
        values: (n,) float64, writable; NaN where the log holds nothing.
        unit: as the log writes it, empty where it does not say.
        frame: frame of a component, where the log says.
        kind: such as "specific_force", where the log says.
        sensor: what measured it, where the log says.
        limits: smallest and largest value that the sensor can give, in ``unit``.
        u: standard uncertainty in ``unit``, where the log says: one number or one per sample.
        joint: the joint of which it is, where only its kind decides the unit.
        quantity: position, velocity or effort of that joint.
        defined: whether its source defines the unit, whatever the name seems to say.
        added_u: what conditioning adds to that of single samples (n,), by the root of the sum of
            squares, wherever it comes from; ``None`` where it adds nothing.
    """

    name: str
    values: Array
    unit: str = ""
    frame: str = ""
    kind: str = ""
    sensor: str = ""
    limits: tuple[float, float] | None = None
    u: float | Array | None = None
    joint: str = ""
    quantity: str = ""
    defined: bool = False
    added_u: Array | None = None


@dataclass
class RawStream:
    """Columns that were sampled together.

    Attributes:
        name: "log" where there is only one.
        columns: all columns, that of the time included.
        time: name of the column that holds the time, ``None`` where samples are evenly spaced.
        start_s: time of the first sample, where there is no column of times [s].
        increment_s: time between samples, where there is no column of times [s].
        counter: name of a column that counts samples up by one, where there is one.
        clock: what stamped the samples.
        row_word: what one row of the log is ("line", "message", "sample").
        first_row: number of the first row, counted from 1 (a line below the header).
        rows: number of each row (n,) where they do not simply follow each other.
        truncated: what is missing at the end, in words; empty where the log is whole.
    """

    name: str
    columns: list[RawColumn]
    time: str | None = None
    start_s: float = 0.0
    increment_s: float | None = None
    counter: str | None = None
    clock: Clock = field(default_factory=lambda: Clock("time column"))
    row_word: str = "line"
    first_row: int = 1
    rows: NDArray[np.int64] | None = None
    truncated: str = ""

    def __len__(self) -> int:
        return len(self.columns[0].values) if self.columns else 0

    def column(self, name: str) -> RawColumn:
        """The column of that name."""
        return next(column for column in self.columns if column.name == name)


@dataclass
class RawLog:
    """A whole log as it was read.

    Attributes:
        streams: at least one.
        events: instants that the importer found (onsets in audio).
        repairs: what the importer itself noticed or did (a byte order mark, a decimal comma).
        ignored: columns or topics that were left out, with the reason: name -> why.
        joints: joint -> kind, where the log describes its robot.
        about: what the log says of itself (device, start time, …).
    """

    streams: list[RawStream]
    events: list[Event] = field(default_factory=list)
    repairs: list[Repair] = field(default_factory=list)
    ignored: dict[str, str] = field(default_factory=dict)
    joints: dict[str, str] = field(default_factory=dict)
    about: dict[str, str] = field(default_factory=dict)


class Spool:
    """Rows that arrive in blocks and become columns; many of them wait on disk, not in memory.

    Args:
        width: number of columns.
    """

    def __init__(self, width: int) -> None:
        self._width = width
        self._waiting: list[Array] = []
        self._files: list[BinaryIO] | None = None
        self._count = 0
        self._held = 0

    def __len__(self) -> int:
        return self._count

    def append(self, rows: Array) -> None:
        """Adds rows (k, width)."""
        rows = np.asarray(rows, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != self._width:
            raise ValueError(f"{rows.shape=}, expected (k, {self._width})")
        self._waiting.append(rows)
        self._count += len(rows)
        self._held += rows.size
        if self._held > SPILL or (self._files is not None and self._held > SPILL // 4):
            self._spill()

    def columns(self) -> list[Array]:
        """All rows as one writable array (n,) for each column."""
        if self._files is None:
            table = np.concatenate(self._waiting) if self._waiting else np.empty((0, self._width))
            return [np.ascontiguousarray(table[:, i]) for i in range(self._width)]
        self._spill()
        columns_: list[Array] = []
        for file in self._files:
            file.flush()
            columns_.append(np.memmap(file, dtype=np.float64, mode="r+", shape=(self._count,)))
        return columns_

    def _spill(self) -> None:
        if self._files is None:
            # unnamed files: they vanish with the last array that looks into them
            self._files = [tempfile.TemporaryFile() for _ in range(self._width)]  # noqa: SIM115
        for rows in self._waiting:
            for i, file in enumerate(self._files):
                file.write(np.ascontiguousarray(rows[:, i]).tobytes())
        self._waiting.clear()
        self._held = 0


@dataclass(frozen=True)
class Head:
    """The beginning of a log, by which its format is recognised.

    Attributes:
        path: the file, or the folder of a log that is one.
        start: its first bytes (a few thousand; empty for a folder).
        members: names of the files in a zip archive or folder, empty otherwise.
    """

    path: Path
    start: bytes
    members: tuple[str, ...] = ()
