"""Text files as logs are written: their encoding, and their lines in blocks."""

from __future__ import annotations

import codecs
import io
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO

from simcompare.errors import InputError
from simcompare.hardware.logs.binary import zip_guard
from simcompare.hardware.raw import IMPORT, told_apart
from simcompare.model.recording import INFO, Repair

#: bytes by which encoding and layout are found
HEAD_BYTES = 1 << 16
#: bytes that are parsed together
BLOCK_BYTES = 1 << 20
#: a line longer than this belongs to no table
MAX_LINE = 16 << 20

_MARKS = ((b"\xef\xbb\xbf", "utf-8"), (b"\xff\xfe", "utf-16-le"), (b"\xfe\xff", "utf-16-be"))


@dataclass(frozen=True)
class Source:
    """A text file, or a member of an archive.

    Attributes:
        label: as messages name it.
        open: opens it for reading bytes.
        encoding: of the file.
        skip: bytes of the byte order mark.
        old_mac: whether lines end with a carriage return alone.
        head: lines at its beginning, without their ends.
        complete: whether these are all lines.
        repairs: what was noticed so far.
        rewrite: makes a line of a table of each, where a console wrote it.
        labels: names and units of the columns that stood beside the values.
        first: number of the first line of the head; a part of a file may begin later.
        last: number of its last line, 0 for that of the file.
        word: that stands in each row of a part, and was taken out.
    """

    label: str
    open: Callable[[], IO[bytes]]
    encoding: str
    skip: int
    old_mac: bool
    head: tuple[str, ...]
    complete: bool
    repairs: tuple[Repair, ...]
    rewrite: Callable[[str], str] | None = None
    labels: tuple[tuple[str, str], ...] = ()
    first: int = 1
    last: int = 0
    word: str = ""

    def head_from(self, line: int) -> tuple[str, ...]:
        """Lines of the head from one on, which is counted in the file."""
        return self.head[line - self.first :]

    def rewritten(
        self, line: Callable[[str], str], labels: Sequence[tuple[str, str]] = ()
    ) -> Source:
        """The same with each line made into another one."""
        before = self.rewrite
        both = (lambda text: line(before(text))) if before else line
        head = tuple(map(line, self.head))
        return replace(self, head=head, rewrite=both, labels=tuple(labels))


@dataclass(frozen=True)
class Part:
    """One of several tables in a file.

    Attributes:
        name: of its stream, empty where it is the only one.
        source: its lines.
        repairs: what was left out beside it.
    """

    name: str
    source: Source
    repairs: tuple[Repair, ...] = ()


def named(words: Sequence[str]) -> list[str]:
    """Names of streams, each once, made of what stands in a file."""
    plain = (re.sub(r"\W+", "_", word.lower()).strip("_") or "table" for word in words)
    return [name.replace(" ", "_") for name in told_apart(plain)]


@dataclass(frozen=True)
class Block:
    """Lines that follow each other.

    Attributes:
        line: number of the first, counted from 1.
        lines: without their ends.
        ended: whether the last one has an end; false only at the end of a file.
    """

    line: int
    lines: list[str]
    ended: bool = True


def source_of(path: Path) -> Source:
    """A file as text.

    Raises:
        InputError: it cannot be read, is empty, or is no text.
    """
    return opened(str(path), lambda: path.open("rb"))


def opened(label: str, open_: Callable[[], IO[bytes]]) -> Source:
    """Text behind an open function.

    Raises:
        InputError: it cannot be read, is empty, or is no text.
    """
    try:
        with open_() as file:
            start = file.read(HEAD_BYTES + 1)
    except zip_guard.ERRORS as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(label, [f"cannot be read: {reason}"]) from None
    return _source(label, open_, start)


def _source(label: str, open_: Callable[[], IO[bytes]], start: bytes) -> Source:
    encoding, skip = encoding_of(start)
    complete = len(start) <= HEAD_BYTES
    text = start[skip:HEAD_BYTES].decode(encoding, errors="replace")
    if not text.strip():
        raise InputError(label, ["is empty; expected a log with at least two samples"])
    if text.count("\0") > len(text) // 100:
        cure = f"name its format: {IMPORT} --as FORMAT"
        raise InputError(label, [f"is no text but binary data; {cure}"])
    old_mac = "\n" not in text and text.count("\r") > 1
    lines = text.replace("\r", "\n").split("\n") if old_mac else text.split("\n")
    lines = lines if complete else lines[:-1]  # the last one may be cut
    repairs = []
    if skip:
        repairs.append(Repair("byte_order_mark", INFO, f"a byte order mark says {encoding}"))
    elif encoding != "utf-8":
        text = f"is not UTF-8; it was read as {encoding}"
        repairs.append(Repair("encoding", INFO, text))
    head = tuple(line.rstrip("\r") for line in lines)
    return Source(label, open_, encoding, skip, old_mac, head, complete, tuple(repairs))


def encoding_of(start: bytes) -> tuple[str, int]:
    """Encoding of a text that begins so, and the length of its byte order mark."""
    for mark, name in _MARKS:
        if start.startswith(mark):
            return name, len(mark)
    sample = start[:1000]
    if len(sample) > 3:  # UTF-16 of digits and Latin letters: every second byte is zero
        even, odd = sample[0::2].count(0), sample[1::2].count(0)
        if odd > 0.4 * len(sample) / 2 and not even:
            return "utf-16-le", 0
        if even > 0.4 * len(sample) / 2 and not odd:
            return "utf-16-be", 0
    try:
        codecs.getincrementaldecoder("utf-8")().decode(start, final=False)
    except UnicodeDecodeError:
        return "latin-1", 0
    return "utf-8", 0


def head_lines(start: bytes) -> list[str]:
    """Lines of the beginning of a log, empty where it is no text."""
    try:
        return list(_source("", lambda: io.BytesIO(start), start).head)
    except InputError:
        return []


def blocks(source: Source, first_line: int = 1) -> Iterator[Block]:
    """All lines of a text from one on, a megabyte at a time.

    Raises:
        InputError: a line without end.
    """
    decoder = codecs.getincrementaldecoder(source.encoding)(errors="replace")
    number, rest, is_last = 1, "", False
    with source.open() as file:
        file.read(source.skip)
        while not is_last:
            data = file.read(BLOCK_BYTES)
            is_last = not data
            text = rest + decoder.decode(data, final=is_last)
            lines = (text.replace("\r", "\n") if source.old_mac else text).split("\n")
            # what stands behind the last line end goes on in the next block
            rest = lines.pop()
            if len(rest) > MAX_LINE:
                raise InputError(
                    source.label, [f"line {number} is longer than {MAX_LINE >> 20} MB; no table"]
                )
            ended = not (is_last and rest)
            lines = [line.rstrip("\r") for line in (lines if ended else [*lines, rest])]
            lines = [*map(source.rewrite, lines)] if source.rewrite else lines
            start = max(number, first_line)
            wanted = lines[start - number : source.last - number + 1 if source.last else None]
            if wanted:
                yield Block(start, wanted, ended or len(wanted) < len(lines) - (start - number))
            number += len(lines)
            is_last = is_last or 0 < source.last < number
