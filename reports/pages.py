"""The PDF report: all that the page in a browser holds, what is folded there as well."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from simcompare.reports.render import matplotlib_, matplotlib_replay
from simcompare.reports.render.paper import GUTTER, SOFT, WIDTH, Cell, Paper, Type
from simcompare.reports.render.parts import Block, KeyNumber, Part
from simcompare.reports.render.tables import Column, Table, printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

_TITLE, _SECTION, _PART = 20.0, 15.0, 11.0
_QUESTION, _CAPTION, _CODE = Type(12, colour=SOFT), Type(9, colour=SOFT), Type(8)
_BODY, _CELL, _HEAD = Type(10), Type(8), Type(8, strong=True)
_SENTENCES = {
    "short": Type(13), "answer": Type(11), "notice": Type(10, strong=True), "remark": _BODY,
    "note": _BODY,
}  # fmt: skip
_SIGNS = {"pass": " ✓", "fail": " ✗"}
#: size of what few readers want, such as an audit, relative to the rest
_SMALL = 0.76
#: columns of words are as wide as their words, at most the first of these with which all fit [inch]
_WORDS = (5.0, 3.2, 1.6, 0.9)
#: of a picture in an inch
_DOTS = 200


def document(blocks: Sequence[Block]) -> list[Canvas]:
    """Pages of all blocks, numbered through."""
    papers = list(map(_paper, blocks))
    counts = [len(paper.pages) for paper in papers]
    firsts = itertools.accumulate(counts, initial=1)
    return [
        page
        for paper, first in zip(papers, firsts, strict=False)
        for page in paper.finish(first, sum(counts))
    ]


def _paper(block: Block) -> Paper:
    paper = Paper(block.title)
    paper.heading(block.title, _TITLE, 0)
    paper.text(block.question, _QUESTION, 0.05)
    paper.text(block.settings, _CAPTION, 0.05)
    first, *others = block.parts
    _part(paper, first)
    for part in others:
        paper.heading(part.title, _SECTION, 0.3, of_figure=_begins_with_figure(part))
        if part.finding:
            paper.text(part.finding, _CAPTION)
        _part(paper, part, 1.0 if part.brief else _SMALL)
    for sentence in block.made_with:
        paper.text(sentence, _CAPTION, 0.05)
    return paper


def _part(paper: Paper, part: Part, scale: float = 1.0) -> None:
    for kind, it in part.items:
        if kind in _SENTENCES:
            paper.text(it, _sized(_SENTENCES[kind], scale), 0.06)
        else:
            _OTHERS[kind](paper, it, scale)


def _sized(type_: Type, scale: float) -> Type:
    return replace(type_, size=type_.size * scale)


def _begins_with_figure(part: Part) -> bool:
    return bool(part.items) and part.items[0][0] == "figure"


def _numbers(paper: Paper, numbers: Sequence[KeyNumber], _scale: float) -> None:
    """The few numbers beside each other."""
    width = WIDTH / len(numbers)
    rows = (
        ([number.label for number in numbers], _CAPTION),
        ([n.value + _SIGNS.get(n.verdict, "") for n in numbers], Type(13, strong=True)),
        ([number.note for number in numbers], _CAPTION),
    )
    paper.text("", _CAPTION)
    for texts, type_ in rows:
        cells = [Cell(text, i * width, width - GUTTER) for i, text in enumerate(texts)]
        paper.row(cells, type_)


def _figure(paper: Paper, figure: Any, _scale: float) -> None:  # noqa: ANN401  (of items, which hold anything)
    paper.figure(figure, _CAPTION)


def _facts(paper: Paper, facts: Any, scale: float) -> None:  # noqa: ANN401
    for name, value in facts.items():
        paper.text(f"{name}: {value}", _sized(_BODY, scale), 0.03)


def _code(paper: Paper, code: str, scale: float) -> None:
    for line in code.splitlines():
        paper.text(line, _sized(_CODE, scale))


def _inner(paper: Paper, part: Part, scale: float) -> None:
    scale = scale if part.brief else _SMALL
    if part.title:
        paper.heading(part.title, _PART * scale, of_figure=_begins_with_figure(part))
    if part.finding:
        paper.text(part.finding, _sized(_CAPTION, scale))
    _part(paper, part, scale)


def _table(paper: Paper, table: Table, scale: float) -> None:
    """A table, in several pieces below each other where it is wider than the page."""
    if table.title:
        paper.heading(table.title, _PART * scale)
    for columns in pieces(table, scale):
        _piece(paper, table, columns, scale)
    if table.note:
        paper.text(table.note, _sized(_CAPTION, scale), 0.05)


def _piece(paper: Paper, table: Table, columns: dict[int, float], scale: float) -> None:
    heads, type_ = [column.full_head for column in table.columns], _sized(_CELL, scale)
    paper.text("", type_)
    head = _cells(table, columns, heads)
    paper.head(head, type_)
    for group in table.groups:
        if group.title:
            paper.text(printable(group.title), _sized(_HEAD, scale), 0.06)
        if group.note:
            paper.text(printable(group.note), _sized(_CAPTION, scale))
        for row in group.rows:
            paper.row(_cells(table, columns, row), type_, head)


def _cells(table: Table, columns: dict[int, float], texts: Sequence[str]) -> list[Cell]:
    lefts = itertools.accumulate((width + GUTTER for width in columns.values()), initial=0.0)
    return [
        Cell(printable(texts[i]), left, width, is_number=bool(i) and not table.columns[i].text)
        for (i, width), left in zip(columns.items(), lefts, strict=False)
    ]


def pieces(table: Table, scale: float = 1.0) -> Iterator[dict[int, float]]:
    """Columns that fit beside each other, each with its width [inch]; the first one in each."""
    for most in _WORDS:
        widths = [_width(table, i, most, scale) for i in range(len(table.columns))]
        if _total(widths) <= WIDTH:
            break
    piece = {0: widths[0]}
    for i, width in list(enumerate(widths))[1:]:
        if len(piece) > 1 and _total([*piece.values(), width]) > WIDTH:
            yield piece
            piece = {0: widths[0]}
        piece[i] = width
    yield piece


def _total(widths: Sequence[float]) -> float:
    return sum(widths) + GUTTER * (len(widths) - 1)


def _width(table: Table, i: int, most: float, scale: float) -> float:
    """Width of a column: of its longest cell, and of the longest word of its head."""
    column: Column = table.columns[i]
    cells = [printable(row[i]) for group in table.groups for row in group.rows]
    longest = scale * max(map(_CELL.width, cells), default=0.0)
    if column.text:
        longest = min(longest, most)
    words = column.full_head.split()
    head = scale * max(map(_HEAD.width, words), default=0.0)
    return min(max(longest, head, 0.3) + 0.02, WIDTH / 2)


def _replay(paper: Paper, replay: Any, _scale: float) -> None:  # noqa: ANN401
    """Paper does not move: several instants in one picture."""
    level = next(iter(replay.levels), "")
    words = f"Several instants, the last one full; {level}." if level else "Several instants."
    content = matplotlib_replay.rendered(replay, level, _DOTS)
    paper.picture(replay.title, content, words, _CAPTION)


_OTHERS: dict[str, Callable[[Paper, Any, float], None]] = {
    "numbers": _numbers, "figure": _figure, "facts": _facts, "code": _code, "table": _table,
    "replay": _replay, "part": _inner,
}  # fmt: skip


def rendered(blocks: Sequence[Block]) -> bytes:
    """The report as one PDF file."""
    return matplotlib_.document(document(blocks))
