"""The messages of one topic on their way to columns."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simcompare.hardware.logs.bags.container import Connection
from simcompare.hardware.logs.bags.layout import Layout, Misfit, Number, TooMuch, pick
from simcompare.hardware.logs.bags.types import NOT_MEASURED, NotDefined, Types, definitions
from simcompare.hardware.logs.bags.walk import layout_of
from simcompare.hardware.raw import Spool, blocks
from simcompare.model.trajectory import Array

#: messages, and bytes, that are decoded together
_BATCH, _BATCH_BYTES = 1024, 1 << 20
#: layouts of one topic that are remembered; beyond it something in it is no measurement
_MAX_LAYOUTS = 4096
#: columns that stand before those of the message: its number, when received, its stamp
_OWN = 3
#: a stamp further from the beginning of the bag is on another clock [ns]
_FAR = 10**15
#: no clock that counts from 1970 shows less [ns]
EPOCH_NS = 10**17
_BILLION = 1_000_000_000
#: above it a whole number may have no float64 [1]
_EXACT = 2.0**53


@dataclass
class Table:
    """Messages of a topic in one frame.

    Attributes:
        frame: ``header.frame_id`` of all of them.
        child: ``child_frame_id``.
        numbers: name -> what is known of a column.
        spool: number, time of receipt [s], stamp [s], then the columns.
        origin_ns: what was subtracted from the stamps.
        first_ns: first stamp, and first time of receipt.
        zeros: messages whose stamp is zero.
        stamped: whether the messages have stamps.
        skipped: field -> why it is left out.
        notes: column -> something that happened in it.
    """

    frame: str
    child: str
    numbers: dict[str, Number] = field(default_factory=dict)
    spool: Spool = field(default_factory=lambda: Spool(_OWN))
    origin_ns: int | None = None
    first_ns: tuple[int, int] = (0, 0)
    zeros: int = 0
    stamped: bool = False
    skipped: dict[str, str] = field(default_factory=dict)
    notes: dict[str, str] = field(default_factory=dict)

    def widen(self, layout: Layout) -> None:
        """Adds the columns of a layout that are new; messages before have nothing there."""
        new = [number for number in layout.numbers if number.name not in self.numbers]
        self.skipped.update(layout.skipped)
        if not new:
            return
        self.numbers.update({number.name: number for number in new})
        old, self.spool = self.spool, Spool(_OWN + len(self.numbers))
        if len(old):
            columns = old.columns()
            empty = len(self.numbers) + _OWN - len(columns)
            for part in blocks(len(old)):
                rows = np.column_stack([column[part] for column in columns])
                gap = np.full((len(rows), empty), np.nan)
                self.spool.append(np.hstack([rows, gap]))


class Topic:
    """Decodes the messages of one topic.

    Args:
        connection: where they come from.
        distribution: ROS 2 distribution that the bag names.
        origin_ns: time from which all clocks of the bag are counted.
    """

    def __init__(self, connection: Connection, distribution: str, origin_ns: int) -> None:
        self.connection, self.origin_ns = connection, origin_ns
        self.publishers = {connection.publisher}
        self.tables: dict[tuple[str, str], Table] = {}
        self.count = 0
        self.source = ""
        self.refused = NOT_MEASURED.get(connection.kind, "")
        self.defined = True
        self.broken: list[tuple[int, str]] = []
        self._times: list[int] = []
        self._data: list[bytes] = []
        self._bytes = 0
        self._layouts: dict[int, list[Layout]] = {}
        self._known = 0
        self._candidates: list[tuple[str, Types]] = []
        self._types: Types | None = None
        if connection.encoding not in ("ros1", "cdr"):
            self.refused = f"is packed as {connection.encoding!r}; known: ros1, cdr"
        if not self.refused:
            try:
                self._candidates = definitions(connection, distribution)
            except NotDefined as reason:
                self.refused, self.defined = str(reason), False

    def add(self, time_ns: int, data: bytes) -> None:
        """Takes one message."""
        self.count += 1
        if self.refused:
            return
        self._times.append(time_ns)
        self._data.append(data)
        self._bytes += len(data)
        if len(self._data) >= _BATCH or self._bytes > _BATCH_BYTES:
            self.flush()

    def flush(self) -> None:
        """Decodes the messages that wait."""
        try:
            if self._data and not self.refused:
                self._decode()
        except TooMuch as reason:
            self.refused = str(reason)
        self._times, self._data, self._bytes = [], [], 0

    def _decode(self) -> None:
        first = self.count - len(self._data)
        received = np.array(self._times, dtype=np.int64)
        lengths = np.fromiter(map(len, self._data), np.int64, len(self._data))
        by_frame: dict[
            tuple[str, str], list[tuple[Layout, NDArray[np.int64], NDArray[np.uint8]]]
        ] = {}
        for length in np.unique(lengths).tolist():
            indices = np.flatnonzero(lengths == length)
            joined = b"".join(self._data[i] for i in indices)
            table = np.frombuffer(joined, np.uint8).reshape(len(indices), length)
            for layout, fitting in self._sorted(table, indices, first):
                key = (
                    layout.texts.get("header.frame_id", ""),
                    layout.texts.get("child_frame_id", ""),
                )
                by_frame.setdefault(key, []).append((layout, indices[fitting], table[fitting]))
        for key, parts in by_frame.items():
            if key not in self.tables and len(self.tables) >= 64:
                raise TooMuch("has more than 64 frames")
            target = self.tables.setdefault(key, Table(*key))
            for layout, _, _ in parts:
                target.widen(layout)
            rows = np.full((len(received), _OWN + len(target.numbers)), np.nan)
            rows[:, 0] = np.nan
            for layout, indices, table in parts:
                self._fill(target, layout, rows, indices, table, received, first)
            target.spool.append(rows[~np.isnan(rows[:, 0])])

    def _sorted(
        self, table: NDArray[np.uint8], indices: NDArray[np.int64], first: int
    ) -> list[tuple[Layout, NDArray[np.int64]]]:
        """Messages of one length, by their layouts."""
        length = table.shape[1]
        known = self._layouts.setdefault(length, [])
        unsorted = np.arange(len(table))
        fitting = []
        position = 0
        while len(unsorted):
            if position == len(known):
                number = int(indices[unsorted[0]])
                layout = self._new(self._data[number], first + number)
                if layout is None:
                    unsorted = unsorted[1:]
                    continue
                known.append(layout)
            fits = known[position].fits(table[unsorted])
            if fits.any():
                fitting.append((known[position], unsorted[fits]))
                unsorted = unsorted[~fits]
            position += 1
        return fitting

    def _new(self, data: bytes, number: int) -> Layout | None:
        """A layout for a message that has none; ``None`` where it does not fit its definition."""
        self._known += 1
        if self._known > _MAX_LAYOUTS:
            raise TooMuch("changes its texts or the lengths of its lists in every message")
        wanted = self._candidates if self._types is None else [(self.source, self._types)]
        faults = []
        for source, types in wanted:
            try:
                layout = layout_of(types, self.connection.kind, data, self.connection.encoding)
            except Misfit as reason:
                faults.append(str(reason))
                continue
            self.source, self._types = source, types
            return layout
        self.broken.append((number + 1, faults[0]))
        return None

    def _fill(
        self, target: Table, layout: Layout, rows: Array, indices: NDArray[np.int64],
        table: NDArray[np.uint8], received: NDArray[np.int64], first: int,
    ) -> None:  # fmt: skip
        rows[indices, 0] = first + indices + 1
        rows[indices, 1] = (received[indices] - self.origin_ns) / 1e9
        stamps = np.zeros(len(indices), dtype=np.int64)
        if layout.stamp >= 0:
            target.stamped = True
            kind = "u4" if self.connection.encoding == "ros1" else "i4"
            seconds = pick(table, layout.stamp, layout.order + kind).astype(np.int64)
            rest = pick(table, layout.stamp + 4, f"{layout.order}u4").astype(np.int64)
            stamps = seconds * _BILLION + rest
            target.zeros += int((stamps == 0).sum())
        if target.origin_ns is None:
            target.origin_ns = self._clock(stamps)
        if target.first_ns == (0, 0):
            target.first_ns = (int(stamps[0]), int(received[indices[0]]))
        rows[indices, 2] = (stamps - target.origin_ns) / 1e9
        names = list(target.numbers)
        for number in layout.numbers:
            rows[indices, _OWN + names.index(number.name)] = self._values(target, number, table)
        for path, cells in layout.off_diagonal.items():
            if path not in target.skipped and table[:, cells].any():
                target.skipped[path] = "only its diagonal is read, as standard uncertainty"

    def _clock(self, stamps: NDArray[np.int64]) -> int:
        """What is subtracted from stamps so that float64 keeps their nanoseconds."""
        real = stamps[stamps != 0]
        if not len(real) or abs(int(real[0]) - self.origin_ns) < _FAR:
            return self.origin_ns
        return int(real[0]) // _BILLION * _BILLION if int(real[0]) > EPOCH_NS else 0

    def _values(self, target: Table, number: Number, table: NDArray[np.uint8]) -> Array:
        values = pick(table, number.at, number.dtype)
        if number.split:
            seconds = values.astype(np.int64)
            if number.split == "time":
                seconds = seconds - self.origin_ns // _BILLION
                target.notes[number.name] = "counts from the same instant as the clock"
            rest = pick(table, number.at + 4, f"{number.dtype[0]}u4")
            return seconds + rest * 1e-9
        numbers = values.astype(np.float64)
        if number.dtype[1:] in ("i8", "u8") and (np.abs(numbers) > _EXACT).any():
            target.notes[number.name] = "has values beyond 2^53, which were rounded"
        return numbers
