"""What a result shows of itself at one glance: a few words, one table, one figure."""

from __future__ import annotations

import base64
import functools
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import jinja2
from markupsafe import Markup, escape

from simcompare.reports.render import matplotlib_
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.tables import Table, printable

_TEMPLATES = Path(__file__).parents[1] / "templates"
#: words and signs that end a judged value; their colour only repeats what they say
_VERDICT = re.compile(r"(?:✓|\bpass$)|(?:✗|\bfail$)")
_COLOURS = {"pass": "#2a9d4a", "✓": "#2a9d4a", "fail": "#d9463e", "✗": "#d9463e"}
#: pixels of a browser to the inch
_PIXELS = 96


@dataclass(frozen=True)
class Glance:
    """A few words, one table and one figure.

    Attributes:
        title: what it is.
        question: that it answers.
        settings: how it was made.
        sentences: the answer.
        legend: what the words of the table mean, a line each.
        table: the numbers.
        notes: what the reader must not miss, such as what did not run.
        figure: the picture.
        scene: draws what the scene looks like, as the content of a PNG file; is asked where
            pictures are shown.
        more: what else the object gives.
    """

    title: str
    question: str = ""
    settings: str = ""
    sentences: tuple[str, ...] = ()
    legend: tuple[str, ...] = ()
    table: Table | None = None
    notes: tuple[str, ...] = ()
    figure: Figure | None = None
    scene: Callable[[], bytes] | None = None
    more: str = ""


def html(glance: Glance) -> str:
    """It as a piece of a page, the picture inside, for a notebook."""
    return _template().render(glance=glance)


def text(glance: Glance) -> str:
    """Its words on a few lines, for a terminal."""
    lines = [
        glance.title,
        glance.question,
        glance.settings,
        *glance.sentences,
        *glance.notes,
        glance.more,
    ]
    return "\n  ".join(printable(line) for line in lines if line)


@functools.cache
def _template() -> jinja2.Template:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        picture=_picture, width=_width, address=_address, marked=_marked, printable=printable
    )
    return environment.get_template("glance.html")


def _picture(figure: Figure) -> str:
    """A figure as an address that holds its pixels."""
    return _address(matplotlib_.shown(matplotlib_.canvas(figure)))


def _address(png: bytes) -> str:
    return f"data:image/png;base64,{base64.b64encode(png).decode()}"


def _width(figure: Figure) -> int:
    """Pixels of a browser from its left to its right."""
    return round(_PIXELS * matplotlib_.size(figure)[0])


def _marked(cell: str) -> Markup:
    """A cell with its verdict in a colour."""
    return Markup(
        _VERDICT.sub(
            lambda found: f'<span style="color:{_COLOURS[found[0]]}">{found[0]}</span>',
            str(escape(printable(cell))),
        )
    )
