"""Tables as plain text of a given width, with every cell in it.

Rich, which did this before, squeezes columns without room to nothing.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterator, Sequence

from simcompare.reports.render.tables import Column, Group, Table, printable

#: letters of a column of words that still reads well, of the narrowest one, and between columns
_GOOD_WORDS, _MIN_WORDS, _GUTTER = 30, 13, 2
#: lines of a head where there is room
_HEAD_LINES = 2
#: where a cell may go on in the next line: at spaces, but not beside ±, and in names such as
#: ode:quickstep@1ms
_SEAMS = re.compile(r"((?<!±)\s+(?!±)|(?<=[:@])(?=\w))")


def lines(table: Table, width: int) -> Iterator[str]:
    """A table as plain text, the title of each group above its rows.

    Nothing is left out: where there is no room for all columns, words are wrapped; where that is
    not enough, the columns that are left stand below, beside the same first column.

    Args:
        table: what to show; a cell may have several lines.
        width: letters on a line.
    """
    for k, block in enumerate(_blocks(table, width)):
        if k:
            yield ""
        yield from _block(block, width)


def _blocks(table: Table, width: int) -> Iterator[Table]:
    """The table in as many parts as there must be, each with the first column."""
    every = range(len(table.columns))
    left, is_first = list(every[1:]), True
    while left or is_first:
        count = len(left)
        while count > 1 and not _fits(table.kept([0, *left[:count]]), width):
            count -= 1
        part = table.kept([0, *left[:count]])
        # what is said of a group is said once
        yield part if is_first else part._replace(groups=tuple(map(_bare, part.groups)))
        left, is_first = left[count:], False


def _bare(group: Group) -> Group:
    return group._replace(note="")


def _fits(table: Table, width: int) -> bool:
    return _total(_squeezed(table, width, hard=False)) <= width


def _block(table: Table, width: int) -> Iterator[str]:
    widths = _squeezed(table, width, hard=True)
    heads = [printable(column.full_head) for column in table.columns]
    yield from _laid_out(table, heads, widths)
    yield "─" * min(_total(widths), width)
    for group in table.groups:
        if group.title:
            yield from textwrap.wrap(printable(group.head), width)
        indent = " " * _indent(table)
        for first, *others in group.rows:
            yield from _laid_out(table, [indent + first, *others], widths)


def _indent(table: Table) -> int:
    return 2 if any(group.title for group in table.groups) else 0


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + _GUTTER * (len(widths) - 1)


def _squeezed(table: Table, width: int, *, hard: bool) -> list[int]:
    """Widths of all columns, made narrower one kind after the other until all fit.

    Args:
        table: the table.
        width: letters on a line.
        hard: whether at last words are broken, where nothing else helps.
    """
    least, words = _widths(table, str.splitlines), _widths(table, _SEAMS.split)
    heads = [_head_width(printable(column.full_head)) for column in table.columns]
    widths = list(map(max, least, heads))
    every = list(enumerate(table.columns))
    prose = [i for i, column in every if column.text and not column.nowrap]
    ranges = [i for i, column in every if not column.text]
    names = [i for i, column in every if column.text and column.nowrap]
    _squeeze(widths, range(len(widths)), least, width)
    _squeeze(widths, prose, [max(n, _GOOD_WORDS) for n in words], width)
    _squeeze(widths, prose, [max(n, _MIN_WORDS) for n in words], width)
    _squeeze(widths, ranges, words, width)
    _squeeze(widths, names, words, width)
    if hard:
        _squeeze(widths, range(len(widths)), [1] * len(widths), width)
    return widths


def _squeeze(widths: list[int], which: Sequence[int], least: Sequence[int], width: int) -> None:
    """Makes some columns narrower, the widest first, until all fit or none can give more."""
    while _total(widths) > width:
        able = [i for i in which if widths[i] > least[i]]
        if not able:
            return
        widths[max(able, key=lambda i: widths[i])] -= 1


def _widths(table: Table, parted: Callable[[str], list[str]]) -> list[int]:
    """Letters that each column needs for the longest part of its cells and word of its head."""
    widths = []
    for i, column in enumerate(table.columns):
        cells = [row[i] for group in table.groups for row in group.rows]
        parts = [printable(part) for cell in cells for part in parted(cell)]
        longest = max(map(len, [*parts, *printable(column.full_head).split()]), default=1)
        widths.append(longest + (_indent(table) if i == 0 else 0))
    return widths


def _head_width(head: str) -> int:
    """Letters with which a head needs two lines at most."""
    least = max(map(len, head.split()), default=1)
    fits = (n for n in range(least, len(head)) if len(textwrap.wrap(head, n)) <= _HEAD_LINES)
    return next(fits, max(least, len(head)))


def _laid_out(table: Table, cells: Sequence[str], widths: Sequence[int]) -> Iterator[str]:
    """One row, on as many lines as its longest cell needs."""
    parts = [_wrapped(cell, width) for cell, width in zip(cells, widths, strict=True)]
    for k in range(max(map(len, parts))):
        shown = [
            _placed(part[k] if k < len(part) else "", width, column)
            for part, width, column in zip(parts, widths, table.columns, strict=True)
        ]
        yield (" " * _GUTTER).join(shown).rstrip()


class _Wrapper(textwrap.TextWrapper):
    def _split(self, text: str) -> list[str]:
        return [part for part in _SEAMS.split(text) if part]


def _wrapped(cell: str, width: int) -> list[str]:
    indent = " " * min(len(cell) - len(cell.lstrip(" ")), width - 1)
    wrapper = _Wrapper(width, initial_indent=indent, subsequent_indent=indent)
    parts = [wrapper.wrap(printable(part)) for part in cell.splitlines()]
    return [line for part in parts for line in part] or [""]


def _placed(text: str, width: int, column: Column) -> str:
    return text.ljust(width) if column.text else text.rjust(width)
