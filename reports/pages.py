"""Pages of the PDF report: the answer, every figure with its caption, and the scores."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from simcompare.reports.render import matplotlib_
from simcompare.reports.render.parts import Block, Part
from simcompare.reports.render.tables import Table, printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

    from simcompare.reports.render.figures import Figure

#: A4 across [inch], and the line height of its text as part of the page
_SIZE, _LINE = (11.69, 8.27), 0.026
_LEFT, _TOP, _BOTTOM = 0.06, 0.93, 0.06
#: letters of 10 points on a line across the page, and of 9 points on the whole page
_WRAP, _CELL_WRAP = 128, 190
#: figures from which on the second has the remarks above it
_TWO = 2
#: a figure needs at least so much of the first page
_ROOM = 0.55
#: a heading is not left alone at the foot of a page
_GROUP = 6 * _LINE
_INK, _SOFT = "#1b1b1b", "#555555"

#: a column is as wide as its longest cell, within these numbers of letters
_MIN_WIDTH, _MAX_WIDTH = 10, 45
#: letters of a table that is as wide as its words, and the space between columns
_TIGHT, _GUTTER = 0.88, 0.012
#: letters of all columns of a table for which there is room
_FITTING = _CELL_WRAP * (1 - 2 * _LEFT) * _TIGHT


class Line(NamedTuple):
    """A row of cells.

    Attributes:
        cells: its texts.
        strong: whether it is a heading.
        widths: of the columns, relative to each other; empty for a single cell.
        numbers: columns that end at their right edge, so that digits stand below each other.
    """

    cells: Sequence[str]
    strong: bool
    widths: Sequence[int] = ()
    numbers: frozenset[int] = frozenset()


def of(block: Block) -> Iterator[Canvas]:
    """Pages of one run."""
    figures = block.figures
    yield from _first(block, figures[0] if figures else None)
    for i, figure in enumerate(figures[1:]):
        yield _with_figure(figure, block.parts[0] if i == 0 else None)
    answer, *others = block.parts
    for part in (replace(answer, answer=(), remarks=()), *others):
        yield from _text_pages(part.title, list(_lines(part)))


def _first(block: Block, figure: Figure | None) -> Iterator[Canvas]:
    """The answer, and below it a figure; on a page of its own where the answer is long."""
    page, answer = _blank(), block.parts[0]
    y = _write(page, _TOP, block.title, size=20, weight="bold")
    y = _write(page, y - 0.01, block.question, size=12, colour=_SOFT)
    for sentence in answer.answer:
        y = _write(page, y - 0.008, sentence, size=12)
    if len(block.figures) < _TWO:  # else they have room beside the second
        y = _remarks(page, y, answer)
    crowded = y < _ROOM
    if figure is not None and not crowded:
        _place(page, figure, y - 0.02)
    yield page
    if figure is not None and crowded:
        yield _with_figure(figure)


def _remarks(page: Canvas, y: float, part: Part) -> float:
    for sentence in part.remarks:
        y = _write(page, y - 0.004, sentence, size=10)
    return y


def _with_figure(figure: Figure, part: Part | None = None) -> Canvas:
    """A figure on a page of its own, below the remarks of a part where one is given."""
    page = _blank()
    y = _TOP if part is None else _remarks(page, _TOP, part) - 0.02
    y = _write(page, y, figure.title, size=16, weight="bold")
    _place(page, figure, y - 0.01)
    return page


def _place(page: Canvas, figure: Figure, top: float) -> None:
    """Draws a figure between ``top`` and its caption at the foot of the page."""
    lines = textwrap.wrap(figure.caption, _WRAP)
    foot = _BOTTOM + len(lines) * _LINE
    _write(page, foot - 0.01, figure.caption, size=10, colour=_SOFT)
    height = top - foot
    grid: Any = page.subfigures(
        3,
        3,
        height_ratios=[1 - top, height, foot],
        width_ratios=[_LEFT, 1 - 2 * _LEFT, _LEFT],
    )
    matplotlib_.draw(grid[1, 1], figure)


def _text_pages(heading: str, rest: list[Line]) -> Iterator[Canvas]:
    """Rows of cells on as many pages as they need."""
    while rest:
        page = _blank()
        y = _write(page, _TOP, heading, size=16, weight="bold") - 0.01
        first = True
        while rest and (
            first or y - _height(rest[0]) > _BOTTOM + (_GROUP if rest[0].strong else 0)
        ):
            line, first = rest.pop(0), False
            y = _row(page, y - (0.012 if line.strong else 0), line)
        yield page


def _columns(line: Line) -> Iterator[tuple[str, float, float, int]]:
    """Each cell with where its column begins and ends and how many letters fit into it."""
    widths = line.widths
    left, scale = _LEFT, (1 - 2 * _LEFT) / sum(widths)
    for cell, width in zip(line.cells, widths, strict=True):
        fitting = int(_CELL_WRAP * scale * width * _TIGHT)
        yield cell, left, left + scale * width - _GUTTER, max(fitting, 1)
        left += scale * width


def _height(line: Line) -> float:
    """Height by which a row is longer than the two lines for which there is always room."""
    if len(line.cells) == 1:
        return 0.0  # long remarks may begin anywhere
    most = max(len(textwrap.wrap(cell, wrap)) for cell, _, _, wrap in _columns(line))
    return max(most - 2, 0) * 0.9 * _LINE


def _row(page: Canvas, y: float, line: Line) -> float:
    weight = "bold" if line.strong else "normal"
    if len(line.cells) == 1:
        return _write(page, y, line.cells[0], size=9, weight=weight)
    lowest = y
    for i, (cell, left, right, wrap) in enumerate(_columns(line)):
        is_number = i in line.numbers
        end = _write(
            page, y, cell, size=9, weight=weight, left=right if is_number else left, wrap=wrap,
            ha="right" if is_number else "left",
        )  # fmt: skip
        lowest = min(lowest, end)
    return lowest


def _lines(part: Part) -> Iterator[Line]:
    """Everything that a part and its parts hold beside figures."""
    if not part.has_text:
        return
    texts = [*part.answer, *part.notices, *part.remarks]
    texts += [f"{key}: {value}" for key, value in part.facts.items()]
    for text in (*texts, *part.notes, *part.code.splitlines()):
        yield Line((text,), False)
    for table in part.tables:
        yield from _grid_lines(table)
    for inner in part.parts:
        if inner.has_text and inner.title:
            yield Line((inner.title,), True)
        yield from _lines(inner)


def _grid_lines(table: Table) -> Iterator[Line]:
    """A table, without the columns that can be spared where there is no room for them."""
    if sum(_widths(table)) > _FITTING:
        table = table.narrow()
    widths, heads = _widths(table), tuple(column.full_head for column in table.columns)
    numbers = frozenset(i for i, column in enumerate(table.columns) if i and not column.text)
    if table.title:
        yield Line((table.title,), True)
    yield Line(heads, True, widths, numbers)
    for group in table.groups:
        if group.title:
            yield Line((printable(group.title),), True)
        if group.note:
            yield Line((printable(group.note),), False)
        for row in group.rows:
            yield Line(tuple(map(printable, row)), False, widths, numbers)
    if table.note:
        yield Line((table.note,), False)


def _widths(table: Table) -> tuple[int, ...]:
    """Letters of each column."""
    rows = [row for group in table.groups for row in group.rows]
    heads = [column.full_head for column in table.columns]
    lengths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    return tuple(min(max(length, _MIN_WIDTH), _MAX_WIDTH) for length in lengths)


def _blank() -> Canvas:
    import matplotlib as mpl
    from matplotlib.figure import Figure as NewCanvas

    with mpl.rc_context():
        return NewCanvas(figsize=_SIZE, layout="constrained")


def _write(
    page: Canvas, y: float, text: str, *, size: float, weight: str = "normal",
    colour: str = _INK, left: float = _LEFT, wrap: int = 0, ha: str = "left",
) -> float:  # fmt: skip
    """Writes wrapped text from ``y`` down and returns where it ends."""
    # a fitting number of letters for the size of the type
    lines = textwrap.wrap(text, wrap or int(_WRAP * 10 / size)) or [""]
    for line in lines:
        # a dollar sign would start mathematics
        shown = line.replace("$", r"\$")
        page.text(left, y, shown, size=size, weight=weight, color=colour, va="top", ha=ha)
        y -= _LINE * size / 10
    return y
