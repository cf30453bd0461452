"""Records with names, as JSON holds them, become columns of numbers."""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from simcompare.errors import InputError
from simcompare.hardware.logs import csv_
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import clocks, console
from simcompare.hardware.logs.text import dates as _dates
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text.dates import DateStyle
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import RawLog
from simcompare.model.recording import INFO, Repair

#: in the place of the line of names, which is read already
_HEADER = "the names of the records"
#: texts that a reader of tables would pass over
_NO_ROW = (*_cell.COMMENTS, "$")
#: numbered records of one table: the number is its line, or counts from 1
Records = Callable[[], Iterable[tuple[int, Any]]]


@dataclass
class _Seen:
    """What the records hold under one name."""

    numbers: int = 0
    texts: int = 0
    example: str = ""
    style: DateStyle | None = None


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
    """Adds a table as a stream: first the names and what stands under them, then the rows."""
    contents: dict[str, _Seen] = {}
    count = 0
    for _, record in records():
        count += 1
        for key, value in _flat(record):
            _notice(contents.setdefault(key, _Seen()), value)
    if not count:
        raise InputError(where, [f"{name}: holds no records"])
    kept = [k for k, seen in contents.items() if seen.numbers >= max(seen.texts, 1)]
    if not kept:
        raise InputError(where, [f"{name}: no record holds a number"])
    words = [key for key, seen in contents.items() if seen.texts and not seen.numbers]
    kept += [key for key in words if _dated(key, contents[key])]
    for key in [key for key in contents if key not in kept]:
        seen = contents[key]
        log.ignored[key] = f"holds text such as {seen.example!r}" if seen.texts else "is empty"
    styles = {i: s for i, k in enumerate(kept) if (s := contents[k].style)}
    kinds = tuple("date" if i in styles else "number" for i in range(len(kept)))
    names = _cell.headings(kept, keep=_cell.wanted_names(mapping))
    layout = Layout("\t", 1, kinds, tuple(names), header=_HEADER, styles=styles)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rows"
        with path.open("wb") as file:
            lacking = _write(file, records, kept)
        _take(log, where, name, word, path, layout, mapping)
    if lacking:
        text = f"{lacking} {word}s lack a value that others have; it is missing there"
        log.repairs.append(Repair("missing_keys", INFO, text, name))


def _take(
    log: RawLog, where: str, name: str, word: str, path: Path, layout: Layout,
    mapping: Mapping,
) -> None:  # fmt: skip
    """Reads the rows as those of any table."""
    try:
        one = csv_.of_layout(_source.opened(where, lambda: path.open("rb")), layout, mapping)
    except InputError as error:
        faults = [_told(fault, word) for fault in error.faults]
        raise InputError(error.where, faults) from None
    for stream in one.streams:
        stream.name = f"{name}_{stream.name}" if len(one.streams) > 1 else name
        stream.row_word = word
    log.streams += one.streams
    log.repairs += [r for r in one.repairs if r.rule != "blank_line"]
    log.ignored |= one.ignored


def _told(fault: str, word: str) -> str:
    """A fault of a line of the table as one of a record, which has no cells to be emptied."""
    return re.sub(r"^line (\d+), column ", rf"{word} \1, ", fault).partition("; where nothing")[0]


def _write(file: IO[bytes], records: Records, kept: list[str]) -> int:
    """Writes a line for each record, at its number, and counts those that lack a value."""
    lacking, at = 0, 1
    place = {key: i for i, key in enumerate(kept)}
    for number, record in records():
        cells = ["nan"] * len(kept)
        found = [(key, value) for key, value in _flat(record) if key in place]
        for key, value in found:
            cells[place[key]] = _text(value)
        lacking += len(found) < len(kept)
        line = "\n" * (number - at) + "\t".join(cells) + "\n"
        file.write(line.encode(errors="replace"))
        at = number + 1
    return lacking


def _text(value: Any) -> str:  # noqa: ANN401
    """A plain value as a cell, which no reader passes over."""
    if value is None:
        return "nan"
    if isinstance(value, str):
        text = " ".join(value.split()).replace('"', "'")
        odd = text.startswith(_NO_ROW) or console.BOOT.match(text)
        return json.dumps(text) if odd else text or "nan"
    return str(int(value)) if isinstance(value, bool) else repr(value)


def _notice(content: _Seen, value: Any) -> None:  # noqa: ANN401
    if isinstance(value, bool | float | int):
        content.numbers += 1
    elif isinstance(value, str):
        content.texts += 1
        content.example = content.example or value[:40]


def _dated(name: str, content: _Seen) -> bool:
    """Whether a column holds dates that are the time; how they are written is noted."""
    if clocks.is_time(name.rpartition(".")[2]):
        content.style = _dates.style_of([content.example])
    return content.style is not None
