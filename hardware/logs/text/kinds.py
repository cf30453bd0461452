"""Rows of several kinds in one file, each of which begins with its kind: a table for each.

IMU,10,0.1,9.8         A: 0.1 9.8 0.0         10 IMU 0.1 9.8
GPS,10,48.1,11.5       G: 1.5 0.2 0.1         10 GPS 48.1 11.5
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from simcompare.hardware.logs import profiles
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text.source import Part, Source, named
from simcompare.model.recording import REPAIR, Repair

#: lines that are looked at first, and the share of them that may have no kind
_LOOKED_AT, _OTHERS = 400, 0.1
#: lines that make a kind, and how many kinds there may be
_MIN_ROWS, _MOST = 3, 60
#: the share of rows that hold a number
_NUMBERS = 0.2
#: lines of a kind by which its layout is found
_SAMPLE = 300
_WORD = r"""(?:[#%]\s*)?["']?(?P<kind>[$A-Za-z_][\w./-]{0,24})["']?\s*(?:[,;|\t:]\s*|\s+)"""
_FIRST = re.compile(rf"\s*(?P<stamp>){_WORD}")
_SECOND = re.compile(rf"(?P<stamp>\s*[\d.]+\s*(?:[,;|\t]\s*|\s+)){_WORD}")
#: names of columns that tell kinds of rows apart
_TOLD_BY = re.compile(r"(?:sensor|msg|message|record|row|data|packet)?[ _]?(?:type|kind|id|name)|"
                      r"sensor|message|msg|topic|device|attribute", re.IGNORECASE)  # fmt: skip
#: first words that are no kinds
_NONE = re.compile(r"(?:Mon|Tue|Wed|Thu|Fri|Sat|Sun|Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov"
                   r"|Dec|nan|inf|true|false|FMT)[a-z]*", re.IGNORECASE)  # fmt: skip
#: names of the columns of a kind, as ArduPilot writes them: FMT, 128, 89, IMU, QBfff, TimeUS,I,GyrX
_FORMAT = re.compile(r"FMT, ?\d+, ?\d+, ?(\w+), ?\w+, ?(.+)")


@dataclass
class _Kind:
    """Lines of a kind: how many, the first of them, and their places."""

    count: int = 0
    lines: dict[int, str] = field(default_factory=dict)


def of(source: Source) -> list[Part]:
    """A table for each kind of rows; none where the rows of a text are of one kind."""
    lines = [line for line in source.head[:_LOOKED_AT] if line.strip()]
    for place in (_FIRST, _SECOND):
        usual = _usual(Counter(_kind(line, place) for line in lines))
        several = len(usual) > 1 or profiles.words() & {*usual}
        header = _shared_header(lines, usual, place) if several else None
        if header is not None:
            return _parts(source, place, header)
    return []


def _kind(line: str, place: re.Pattern[str]) -> str:
    match = place.match(line)
    return match["kind"] if match and not _NONE.fullmatch(match["kind"]) else ""


def _usual(counts: Counter[str]) -> list[str]:
    """Kinds that are more than once there; none where they are not nearly all."""
    usual = [kind for kind, count in counts.items() if kind and count >= _MIN_ROWS]
    others = sum(counts.values()) - sum(counts[kind] for kind in usual)
    return usual if others <= _OTHERS * sum(counts.values()) + len(usual) else []


def _shared_header(
    lines: Sequence[str], usual: Sequence[str], place: re.Pattern[str]
) -> str | None:
    """The header of all kinds, empty where there is none; ``None`` for a table with a text."""
    rows = [line for line in lines if _kind(line, place) in usual]
    if sum(map(_has_number, rows)) < _NUMBERS * len(rows):
        return None
    separator = max(",;\t|", key=rows[0].count)
    width = len(_cell.split(rows[0], separator))
    for line in lines[: lines.index(rows[0])]:
        names = _cell.split(line.lstrip(" #%/!"), separator)
        if len(names) == width > 2 and all(_cell.kind_of(name) == "text" for name in names):
            told = place is _FIRST and _TOLD_BY.fullmatch(names[0].strip())
            return line if told else None
    return ""


def _has_number(line: str) -> bool:
    cells = re.split(r"[,;|=:\s]+", line)
    return any(_cell.number(cell) is not None for cell in cells if cell)


def _parts(source: Source, place: re.Pattern[str], header: str) -> list[Part]:
    kinds: dict[str, _Kind] = {}
    shared: dict[int, str] = {}
    for at, line in _lines(source):
        kind = _kind(line, place)
        if header and line == header:
            shared[at] = line
        elif kind:
            one = kinds.setdefault(kind, _Kind())
            one.count += 1
            if len(one.lines) < _SAMPLE:
                one.lines[at] = line
    rare = [kind for kind, one in kinds.items() if one.count < _MIN_ROWS]
    usual = [kind for kind in kinds if kind not in rare][:_MOST]
    made = [
        _part(source, kind, {**shared, **kinds[kind].lines}, _only(kind, place, header), name)
        for kind, name in zip(usual, named(usual), strict=True)
    ]
    left = [kind for kind in kinds if kind not in usual]
    if left:
        text = f"rows of {', '.join(left)[:200]} are too few for a table, and were left out"
        told = Repair("few_rows", REPAIR, text, count=sum(kinds[kind].count for kind in left))
        made[0] = replace(made[0], repairs=(told,))
    return made


def _lines(source: Source) -> Iterator[tuple[int, str]]:
    for block in _source.blocks(source):
        yield from enumerate(block.lines, start=block.line)


def _part(
    source: Source, kind: str, lines: dict[int, str], line: Callable[[str], str], name: str
) -> Part:
    """The table of one kind; all other lines are empty in it."""
    first = min(lines)
    head = [""] * (max(lines) - first + 1)
    for at, text in lines.items():
        head[at - first] = text
    whole = replace(source, head=tuple(head), first=first, complete=False, word=kind)
    formats = [text for text in source.head if _formatted(text, kind)]
    if formats:  # names above the rows
        whole = replace(whole, head=(formats[0], *head), first=first - 1)
    return Part(name, whole.rewritten(line))


def _only(kind: str, place: re.Pattern[str], header: str) -> Callable[[str], str]:
    """Makes lines of a kind into rows without it, and empties all others."""

    def rewrite(line: str) -> str:
        match = place.match(line)
        if match and (match["kind"] == kind or (header and line == header)):
            return match["stamp"] + line[match.end() :]
        return _formatted(line, kind)

    return rewrite


def _formatted(line: str, kind: str) -> str:
    match = _FORMAT.fullmatch(line.strip())
    return match[2] if match and match[1] == kind else ""
