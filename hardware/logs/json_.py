"""JSON: a list of records, an object that holds such lists or columns, and JSON lines.

What stands beside the records as plain values describes the log. Records within records become
columns ``outer.inner``, lists of numbers ``name[0]``, ``name[1]``, ….
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from simcompare.errors import InputError
from simcompare.hardware.logs.text import records as _records
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text.state import Faults
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawLog

TITLE = "JSON"

_Table = tuple[str, _records.Records]

_OPEN, _CLOSE = "[{", {"[": "]", "{": "}"}


def recognises(head: Head) -> int:
    """High for what begins as JSON does."""
    lines = [] if head.members else _source.head_lines(head.start)
    text = "\n".join(lines).lstrip()
    stamp = r"\d+[-:]\d|[\d.]+ ?[a-zµ]+\s*\]"  # [09:41:07] and [1530 ms] of a console
    begins = re.match(rf'\{{\s*"[^"]*"\s*:|\[\s*(?!{stamp})[\[{{\d\-]|\{{\s*\}}', text)
    return 70 if begins and not re.match(r"\[[^\]\n,:]*\]\s*$", lines[0].strip()) else 0


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all tables of the file, each as a stream.

    Raises:
        InputError: no JSON, no records, or values that are no numbers.
    """
    source = _source.source_of(path)
    log = RawLog([], repairs=list(source.repairs))
    if _is_lines(source):
        lines = _Lines(source)
        _records.add(log, str(path), "log", "line", lines.records, mapping)
        log.streams[0].truncated = lines.truncated
        return log
    with source.open() as file:
        text = file.read()[source.skip :].decode(source.encoding, errors="replace")
    tree, truncated = _parsed(str(path), text)
    del text
    if not isinstance(tree, dict | list):
        raise InputError(str(path), ["is one value, no log; expected a list of records"])
    tables = dict(_tables(str(path), tree, "", log))
    if not tables:
        raise InputError(
            str(path), ["holds no table; expected a list of records such as"
                        ' [{"time": 0.0, "angle": 0.1}, …] or lists of equal length'],
        )  # fmt: skip
    for name, records in tables.items():
        called = name if len(tables) > 1 and name else "log"
        _records.add(log, str(path), called, "record", records, mapping)
    log.streams[-1].truncated = truncated
    return log


# ---- JSON lines -------------------------------------------------------------------------------


def _is_lines(source: _source.Source) -> bool:
    """Whether every line is a record of its own."""
    full = [line.strip() for line in source.head if line.strip()][:2]
    try:
        return len(full) == 2 and all(isinstance(json.loads(line), dict) for line in full)
    except (ValueError, RecursionError):
        # the second may be cut or faulty: two records in two lines are no other JSON
        return len(full) == 2 and full[0][:1] + full[0][-1:] + full[1][:1] == "{}{"


class _Lines:
    def __init__(self, source: _source.Source) -> None:
        self.source = source
        self.truncated = ""

    def records(self) -> Iterator[tuple[int, Any]]:
        """All records with their lines."""
        faults = Faults(self.source.label)
        for block in _source.blocks(self.source):
            for at, line in enumerate(block.lines, start=block.line):
                if not line.strip():
                    continue
                try:
                    record = json.loads(line)
                except (ValueError, RecursionError) as error:
                    if not block.ended and at == block.line + len(block.lines) - 1:
                        self.truncated = f"line {at} ends in the middle; it was left out"
                    else:
                        faults.add(f"line {at}: is no JSON record ({error})")
                    continue
                if isinstance(record, dict):
                    yield at, record
                else:
                    faults.add(f"line {at}: is a {type(record).__name__}, expected a record {{…}}")
        faults.finish()


# ---- one document -----------------------------------------------------------------------------


def _parsed(where: str, text: str) -> tuple[Any, str]:
    """The document, and what is missing where it is cut."""
    try:
        return json.loads(text), ""
    except RecursionError:
        raise InputError(where, ["is nested too deeply to be a log"]) from None
    except ValueError as error:
        complete = _up_to_last_record(text)
        if complete is not None:
            at = len(complete.encode())
            try:
                tree = json.loads(complete + _closers(complete))
            except (ValueError, RecursionError):
                pass
            else:
                return tree, f"ends too early; its last whole record ends at byte {at}"
        place = ""
        if isinstance(error, json.JSONDecodeError):
            place = f"line {error.lineno}, column {error.colno}: "
            error = ValueError(error.msg)
        raise InputError(where, [f"{place}is no JSON ({error})"]) from None


def _up_to_last_record(text: str) -> str | None:
    """The text up to the end of its last whole record, where it ends within the next one."""
    begin = re.search(r"\[\s*(?=[\[{])", text)
    if begin is None:
        return None
    decoder = json.JSONDecoder()
    at, last = begin.end(), None
    gap = re.compile(r"\s*,\s*")
    while True:
        try:
            _, end = decoder.raw_decode(text, at)
        except (ValueError, RecursionError) as error:
            place = getattr(error, "pos", 0)
            cut = len(text) - place < 64 or "Unterminated" in str(error)
            return text[:last] if last is not None and cut else None
        last = end
        comma = gap.match(text, end)
        if comma is None:
            return text[:last] if not text[end:].strip(" \t\r\n]}") else None
        at = comma.end()


def _closers(text: str) -> str:
    """Brackets that are open at the end of a text."""
    open_: list[str] = []
    for token in re.finditer(r'"(?:[^"\\]|\\.)*"|[\[\]{}]', text):
        if token[0] in _OPEN:
            open_.append(token[0])
        elif token[0] in "]}" and open_:
            open_.pop()
    return "".join(_CLOSE[bracket] for bracket in reversed(open_))


def _tables(where: str, tree: Any, name: str, log: RawLog) -> Iterator[_Table]:  # noqa: ANN401
    """Every table in a document; plain values beside them go into ``log.about``."""
    if isinstance(tree, list):
        plain = tree and not isinstance(tree[0], dict | list)
        yield name, lambda: enumerate(([value] for value in tree) if plain else tree, start=1)
        return
    columns = {k: v for k, v in tree.items() if isinstance(v, list) and not _is_records(v)}
    if _is_table(where, name, columns):
        yield name, lambda: enumerate(_rows(columns), start=1)
    else:
        for key, values in columns.items():
            log.ignored[f"{name}.{key}" if name else key] = f"is a list of {len(values)} values"
    for key, value in tree.items():
        full = f"{name}.{key}" if name else key
        if isinstance(value, dict) or _is_records(value):
            yield from _tables(where, value, full, log)
        elif not isinstance(value, list) and value is not None:
            log.about[full] = str(value)


def _is_table(where: str, name: str, columns: dict[str, list[Any]]) -> bool:
    """Whether lists are the columns of one table.

    Raises:
        InputError: they have different lengths.
    """
    lengths = {len(values) for values in columns.values()}
    if not columns or max(lengths) < 2:
        return False
    if len(lengths) > 1:
        counts = ", ".join(f"{key}: {len(values)}" for key, values in columns.items())
        raise InputError(
            where, [f"{name or 'the document'}: lists of different lengths ({counts[:300]});"
                    " expected columns of one length"],
        )  # fmt: skip
    return True


def _is_records(value: Any) -> bool:  # noqa: ANN401
    return isinstance(value, list) and bool(value) and isinstance(value[0], dict)


def _rows(columns: dict[str, list[Any]]) -> Iterator[dict[str, object]]:
    for values in zip(*columns.values(), strict=True):
        yield dict(zip(columns, values, strict=True))
