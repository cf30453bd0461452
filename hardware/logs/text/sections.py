"""Tables below each other in one file, with empty lines between them: each is read by itself.

Trajectories
100
Frame,x,y
1,0.1,0.2

Devices
1000
Frame,Fx,Fy
1,0.3,0.4
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from simcompare.errors import InputError
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import sniff
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.logs.text.source import Part, Source, named
from simcompare.model.recording import REPAIR, Repair

#: lines of a stretch that are looked at; with more stretches, empty lines part nothing
_SAMPLE, _MOST = 300, 200
#: rows that make a table, or go on with it where there are no more
_MIN_ROWS = 3


@dataclass
class _Stretch:
    """Lines between empty ones."""

    first: int
    last: int
    lines: list[str]


@dataclass
class _Table:
    """A table and where it stands, with what is written above it."""

    first: int
    last: int
    head: tuple[str, ...]
    layout: Layout


def of(source: Source) -> list[Part]:
    """The tables of a text, in their order; one with the whole text where there is no second."""
    stretches = _stretches(source)
    tables = _tables(source, stretches) if 1 < len(stretches) <= _MOST else []
    if not tables:
        return [Part("", source)]
    names = [_name(table, number) for number, table in enumerate(tables, start=1)]
    made = [
        Part(name, replace(source, head=table.head, first=table.first, last=table.last))
        for name, table in zip(named(names), tables, strict=True)
    ]
    # the first one keeps all that is known of the beginning of the file
    made[0] = replace(made[0], source=replace(source, last=tables[0].last,
                                              head=source.head[: tables[0].last]))  # fmt: skip
    below = [stretch for stretch in stretches if stretch.first > tables[-1].last]
    repairs = tuple(_left_out(below)) if below else ()
    if len(made) == 1:
        return [Part("", made[0].source if below else source, repairs)]
    return [*made[:-1], replace(made[-1], repairs=repairs)]


def _stretches(source: Source) -> list[_Stretch]:
    made: list[_Stretch] = []
    is_open = False
    for block in _source.blocks(source):
        for at, line in enumerate(block.lines, start=block.line):
            if not line.strip(' ,;\t"'):
                is_open = False
                continue
            if not is_open:
                made.append(_Stretch(at, at, []))
                is_open = True
                if len(made) > _MOST:
                    return made
            made[-1].last = at
            if len(made[-1].lines) < _SAMPLE:
                made[-1].lines.append(line)
    return made


def _tables(source: Source, stretches: Sequence[_Stretch]) -> list[_Table]:
    made: list[_Table] = []
    above: list[_Stretch] = []  # what may be the head of the next table
    for stretch in stretches:
        above.append(stretch)
        table = _table(source, above)
        header = table.layout.header.strip() if table else ""
        again = bool(made) and header in ("", made[-1].layout.header.strip())
        if again and _goes_on(stretch, made[-1].layout):
            made[-1].last = stretch.last
        elif table:
            made.append(table)
        else:
            continue
        above = []
    return made


def _table(source: Source, stretches: Sequence[_Stretch]) -> _Table | None:
    """What stretches hold: rows of numbers, the first of which is none of a list of settings."""
    first, last = stretches[0].first, stretches[-1]
    head: list[str] = []
    for stretch in stretches:
        head += [*[""] * (stretch.first - first - len(head)), *stretch.lines]
    part = replace(source, head=tuple(head), first=first, complete=False, labels=())
    try:
        layout = sniff.sniff(part)
    except InputError:
        return None
    numbers = sum(kind in ("number", "date") for kind in layout.kinds)
    if not _goes_on(last, layout) or numbers < 2 or layout.kinds[0] not in ("number", "date"):
        return None
    return _Table(first, last.last, part.head, layout)


def _goes_on(stretch: _Stretch, layout: Layout) -> bool:
    """Whether more rows of a table stand in a stretch than anything else, or a few of them."""
    rows = [_cell.split(line, layout.separator) for line in stretch.lines]
    fitting = sum(sniff.fits(cells, layout.kinds) for cells in rows)
    return fitting >= min(_MIN_ROWS, len(rows))


def _name(table: _Table, number: int) -> str:
    """The word above a table, or its number."""
    word = table.layout.preamble[0].strip(' ,;\t"#:[]') if table.layout.preamble else ""
    return word if word.replace(" ", "").isalpha() and len(word) <= 30 else f"table_{number}"


def _left_out(below: Sequence[_Stretch]) -> list[Repair]:
    rows = tuple((stretch.first, stretch.last) for stretch in below)
    text = f"text below the table was left out, such as {below[0].lines[0].strip()[:60]!r}"
    return [Repair("trailing_text", REPAIR, text, rows=rows,
                   count=sum(b - a + 1 for a, b in rows))]  # fmt: skip
