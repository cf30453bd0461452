"""Pages of paper that are filled from top to bottom: headings, sentences, tables and figures."""

from __future__ import annotations

import functools
import io
import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from simcompare.reports.render import matplotlib_
from simcompare.reports.render.figures import Figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas
    from matplotlib.ft2font import FT2Font

#: A4 across, its margins and the height of the foot [inch]
SIZE = (11.69, 8.27)
LEFT, TOP, FOOT = 0.6, 0.5, 0.65
WIDTH = SIZE[0] - 2 * LEFT
#: from a point of type to the height of its line [inch], and the space between columns [inch]
_LINE, GUTTER = 1.25 / 72, 0.15
#: a heading is not left alone at the foot of a page; heights of figures and their titles [inch]
_KEEP, _MIN_FIGURE, _USUAL_FIGURE, _TITLE = 1.1, 2.8, 4.4, 0.4
#: what title and caption of a figure take, roughly [inch]
_AROUND = 1.1
INK, SOFT = "#1b1b1b", "#555555"
_PIXELS = 100


@dataclass(frozen=True)
class Type:
    """How letters look.

    Attributes:
        size: in points.
        strong: whether they are bold.
        colour: as ``#rrggbb``.
    """

    size: float
    strong: bool = False
    colour: str = INK

    @property
    def line(self) -> float:
        """Height of a line [inch]."""
        return self.size * _LINE

    def width(self, text: str) -> float:
        """Width of a text on one line [inch]."""
        return sum(_advance(letter, self.strong) for letter in text) * self.size / 72

    def wrapped(self, text: str, width: float) -> list[str]:
        """A text on as many lines as it needs; a word that is too long is broken."""
        lines = [""]
        for word in text.split():
            longer = f"{lines[-1]} {word}".strip()
            if self.width(longer) <= width:
                lines[-1] = longer
                continue
            if lines[-1]:
                lines.append("")
            for letter in word:
                if lines[-1] and self.width(lines[-1] + letter) > width:
                    lines.append("")
                lines[-1] += letter
        return lines


@dataclass(frozen=True)
class Cell:
    """A text in a column.

    Attributes:
        text: what is written.
        left: where the column begins [inch from the left margin].
        width: of the column [inch].
        is_number: whether it ends at the right edge, so that digits stand below each other.
    """

    text: str
    left: float
    width: float
    is_number: bool = False


class Paper:
    """Pages that grow as they are written on.

    Attributes:
        pages: those that there are.
    """

    def __init__(self, title: str) -> None:
        self._title = title
        self.pages: list[Canvas] = []
        self._has_figure = False
        self._turn()

    def text(self, text: str, type_: Type, gap: float = 0.0) -> None:
        """A sentence across the page, below a gap [inch]."""
        self._y += gap
        for line in type_.wrapped(text, WIDTH):
            self._need(type_.line)
            self._write(line, LEFT, type_)
            self._y += type_.line

    def heading(
        self, text: str, size: float, gap: float = 0.15, *, of_figure: bool = False
    ) -> None:
        """A heading, which is followed by something, such as a figure, on the same page."""
        high = gap + 2 * size * _LINE
        if of_figure and (self._has_figure or self._free < high + _AROUND + _MIN_FIGURE):
            self._turn()
        self._need(_KEEP + high)
        self.text(text, Type(size, strong=True), gap)

    def row(self, cells: Sequence[Cell], type_: Type, head: Sequence[Cell] = ()) -> None:
        """Texts beside each other, on a new page below the heads of their columns."""
        lines = [type_.wrapped(cell.text, cell.width) for cell in cells]
        high = max(map(len, lines)) * type_.line
        if self._need(min(high, SIZE[1] - TOP - FOOT)) and head:
            self.head(head, type_)
        for texts in itertools.zip_longest(*lines, fillvalue=""):
            self._need(type_.line)
            for cell, text in zip(cells, texts, strict=True):
                end = LEFT + cell.left + (cell.width if cell.is_number else 0)
                self._write(text, end, type_, right=cell.is_number)
            self._y += type_.line

    def head(self, cells: Sequence[Cell], type_: Type) -> None:
        """The heads of columns, with a line below them; followed by rows on the same page."""
        from matplotlib.lines import Line2D

        self._need(_KEEP)
        self.row(cells, replace(type_, strong=True))
        ends = LEFT / SIZE[0], (LEFT + max(c.left + c.width for c in cells)) / SIZE[0]
        y = 1 - self._y / SIZE[1]
        self.pages[-1].add_artist(Line2D(ends, (y, y), linewidth=0.6, color=INK))
        self._y += 0.03

    def figure(self, figure: Figure, caption: Type) -> None:
        """A figure with its title and its caption; no more than one on a page."""
        lines = caption.wrapped(figure.caption, WIDTH)
        around = _TITLE + len(lines) * caption.line + 0.1
        if self._has_figure or self._free - around < _MIN_FIGURE:
            self._turn()
        height = min(max(_USUAL_FIGURE * figure.height, _MIN_FIGURE), self._free - around)
        self.heading(figure.title, 11)
        self._has_figure = True
        matplotlib_.draw(self._room(height), figure)
        self._y += height
        self.text(figure.caption, caption, 0.05)

    def picture(self, title: str, content: bytes, words: str, caption: Type) -> None:
        """A picture of so many dots with its title and its caption; it counts as a figure."""
        from matplotlib.image import imread

        dots = imread(io.BytesIO(content))
        around = _TITLE + len(caption.wrapped(words, WIDTH)) * caption.line + 0.1
        if self._has_figure or self._free - around < _MIN_FIGURE:
            self._turn()
        self.heading(title, 11)
        self._has_figure = True
        height = min(_USUAL_FIGURE, self._free - around)
        axes = self._room(height).subplots()
        axes.imshow(dots)
        axes.set_axis_off()
        self._y += height
        self.text(words, caption, 0.05)

    def finish(self, first: int, count: int) -> list[Canvas]:
        """All pages, each with title and number at its foot."""
        for number, page in enumerate(self.pages, start=first):
            self._y = SIZE[1] - 0.45
            small = Type(8, colour=SOFT)
            self._write(self._title, LEFT, small, page)
            self._write(f"{number} / {count}", LEFT + WIDTH, small, page, right=True)
        return self.pages

    def _room(self, height: float) -> Any:  # noqa: ANN401
        """The part of the page in which a figure of a height [inch] stands."""
        heights = [self._y, height, SIZE[1] - self._y - height]
        page: Any = self.pages[-1]
        return page.subfigures(3, 3, height_ratios=heights, width_ratios=[LEFT, WIDTH, LEFT])[1, 1]

    @property
    def _free(self) -> float:
        """What is left of the page [inch]."""
        return SIZE[1] - FOOT - self._y

    def _need(self, height: float) -> bool:
        """Begins a page where there is no room for so much [inch]; whether it did."""
        if height <= self._free:
            return False
        self._turn()
        return True

    def _turn(self) -> None:
        self.pages.append(matplotlib_.blank(SIZE))
        self._y, self._has_figure = TOP, False

    def _write(
        self, text: str, x: float, type_: Type, page: Canvas | None = None, *, right: bool = False
    ) -> None:
        (page or self.pages[-1]).text(
            x / SIZE[0], 1 - self._y / SIZE[1], matplotlib_.plain(text), size=type_.size,
            weight="bold" if type_.strong else "normal", color=type_.colour, va="top",
            ha="right" if right else "left",
        )  # fmt: skip


@functools.cache
def _font(strong: bool) -> FT2Font:
    from matplotlib.font_manager import FontProperties, findfont
    from matplotlib.ft2font import FT2Font

    weight = "bold" if strong else "normal"
    font = FT2Font(findfont(FontProperties(family=matplotlib_.FONT, weight=weight)))
    font.set_size(_PIXELS, 72)
    return font


@functools.cache
def _advance(letter: str, strong: bool) -> float:
    """Width of a letter, relative to its size; a byte that is no letter is drawn as one."""
    letter = letter.encode("utf-8", "replace").decode("utf-8")
    return _font(strong).load_char(ord(letter)).linearHoriAdvance / 65536 / _PIXELS
