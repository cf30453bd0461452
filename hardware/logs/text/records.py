"""Records with names, as JSON holds them, become columns of numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.hardware import proposed_time
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import clocks
from simcompare.hardware.logs.text import dates as _dates
from simcompare.hardware.logs.text.state import Faults
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import RawColumn, RawLog, RawStream, Spool
from simcompare.model.recording import INFO, Clock, Repair
from simcompare.model.trajectory import Array

_BLOCK = 20_000
#: whole numbers from here on are rounded by a float
_EXACT = 1 << 53

#: numbered records of one table: the number is its line, or counts from 1
Records = Callable[[], Iterable[tuple[int, Any]]]


@dataclass
class _Seen:
    """What the records hold under one name."""

    numbers: int = 0
    texts: int = 0
    example: str = ""
    largest: int = 0


def _flat(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:  # noqa: ANN401
    """All plain values of a record with their full names."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _flat(inner, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from _flat(inner, f"{name}[{i}]" if name else f"column_{i + 1}")
    else:
        yield name or "column_1", value


def add(log: RawLog, where: str, name: str, word: str, records: Records, mapping: Mapping) -> None:
    """Adds a table as a stream: first the names and what stands under them, then the numbers."""
    contents: dict[str, _Seen] = {}
    count = 0
    for _, record in records():
        count += 1
        for key, value in _flat(record):
            _notice(contents.setdefault(key, _Seen()), value)
    if not count:
        raise InputError(where, [f"{name}: holds no records"])
    kept = [key for key, content in contents.items() if content.numbers >= max(content.texts, 1)]
    dates = {k for k, s in contents.items() if s.texts and not s.numbers and _is_date(k, s)}
    for key, content in contents.items():
        if key not in kept and key not in dates:
            text = f"holds text such as {content.example!r}" if content.texts else "is empty"
            log.ignored[key] = text
    if not kept:
        raise InputError(where, [f"{name}: no record holds a number"])
    time = _time_of(where, [*kept, *sorted(dates)], mapping)
    origin = 0
    if time is not None and time in kept and contents[time].largest > _EXACT:
        origin = next(v for _, r in records() for k, v in _flat(r) if k == time)
    table = _Filled(where, kept, sorted(dates), word, {time: origin} if origin else {})
    for number, record in records():
        table.row(number, record)
    columns, rows = table.columns(log, name, _cell.wanted_names(mapping))
    called = None if time is None else columns[table.place[time]].name
    stream = RawStream(name, columns, called, row_word=word, rows=rows)
    stream.clock = Clock(f"column {time}" if time else "no clock", table.start(time, origin, log))
    log.streams.append(stream)


def _notice(content: _Seen, value: Any) -> None:  # noqa: ANN401
    if isinstance(value, bool | float):
        content.numbers += 1
    elif isinstance(value, int):
        content.numbers += 1
        content.largest = max(content.largest, abs(value))
    elif isinstance(value, str):
        content.texts += 1
        content.example = content.example or value[:40]


def _is_date(name: str, content: _Seen) -> bool:
    return (
        clocks.is_time(name.rpartition(".")[2]) and _dates.style_of([content.example]) is not None
    )


def _time_of(where: str, names: list[str], mapping: Mapping) -> str | None:
    short = {name: _cell.heading(name)[0] for name in names}
    if mapping.time is not None:
        wanted = {*mapping.time.columns}
        return next((n for n in names if wanted & {n, short[n]}), None)
    times = [name for name in names if clocks.is_time(short[name].rpartition(".")[2])]
    if len(times) > 1:
        raise InputError(where, [proposed_time.several([RawColumn(n, np.empty(0)) for n in times])])
    return times[0] if times else None


class _Filled:
    """Records as rows of numbers, in blocks."""

    def __init__(
        self, where: str, kept: list[str], dates: list[str], word: str, origins: dict[Any, int]
    ) -> None:
        self.kept, self.dates, self.word, self.origins = kept, dates, word, origins
        self.place = {key: i for i, key in enumerate([*kept, *dates])}
        self.faults = Faults(where)
        self.spool = Spool(len(self.place))
        self.first: dict[str, int] = {}
        self.waiting: list[Array] = []
        self.numbers: list[int] = []
        self.missing = 0

    def row(self, number: int, record: Any) -> None:  # noqa: ANN401
        values = np.full(len(self.place), np.nan)
        count = 0
        for key, value in _flat(record):
            place = self.place.get(key)
            if place is None or value is None:
                count += place is not None
                continue
            count += 1
            made = self._value(key, value)
            if made is None:
                wanted = "a date" if key in self.dates else "a number"
                self.faults.add(f"{self.word} {number}, {key!r}: {value!r:.60} is not {wanted}")
            else:
                values[place] = made
        self.missing += count < len(self.place)
        self.waiting.append(values)
        self.numbers.append(number)
        if len(self.waiting) >= _BLOCK:
            self._flush()

    def _value(self, key: str, value: Any) -> float | None:  # noqa: ANN401
        if key in self.dates:
            style = _dates.style_of([value]) if isinstance(value, str) else None
            stamp = _dates.nanoseconds([value], style) if style is not None else None
            if stamp is None:
                return None
            return (int(stamp[0]) - self.first.setdefault(key, int(stamp[0]))) / 1e9
        if isinstance(value, str):
            return None
        try:
            return float(value - self.origins.get(key, 0))
        except OverflowError:
            return None

    def _flush(self) -> None:
        if self.waiting:
            self.spool.append(np.stack(self.waiting))
        self.waiting = []

    def columns(
        self, log: RawLog, stream: str, keep: set[str]
    ) -> tuple[list[RawColumn], NDArray[np.int64] | None]:
        """The finished columns, and the numbers of the rows where they do not count from 1."""
        self._flush()
        self.faults.finish()
        if self.missing:
            text = f"{self.missing} {self.word}s lack a value that others have; it is missing there"
            log.repairs.append(Repair("missing_keys", INFO, text, stream))
        heads = _cell.headings(list(self.place), keep=keep)
        columns = [
            RawColumn(name, values, "s" if key in self.dates else unit)
            for key, (name, unit), values in zip(
                self.place, heads, self.spool.columns(), strict=True
            )
        ]
        rows = np.array(self.numbers, dtype=np.int64)
        plain = len(rows) == 0 or (rows[0] == 1 and rows[-1] == len(rows))
        return columns, None if plain else rows

    def start(self, time: str | None, origin: int, log: RawLog) -> str:
        """When the first sample was taken, where the log says."""
        if time is not None and time in self.first:
            start = _dates.iso(self.first[time])
            text = f"dates were read as seconds since {start}"
            log.repairs.append(Repair("date_text", INFO, text, channel=time))
            return start
        if origin:
            text = f"{origin} was taken away from all stamps, as a float would round them"
            log.repairs.append(Repair("large_stamps", INFO, text, channel=time or ""))
        return ""
