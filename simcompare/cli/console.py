"""Printing for people: numbers with their uncertainty, progress on stderr."""

from __future__ import annotations

import json
import re
import shutil
import sys
import textwrap
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import IO, TYPE_CHECKING, cast

import typer

from simcompare.cli import manner, streams
from simcompare.errors import InputError

if TYPE_CHECKING:
    from simcompare.reports.render.tables import Table
    from simcompare.running.runner import Progress


#: what stands on both sides of it stays on one line
_TIED = "\u00a0"
#: such as a value and its scatter
_UNBROKEN = {" ± ": f"{_TIED}±{_TIED}", "(± ": f"(±{_TIED}"}
#: what begins like a number, or is empty
_NUMBER = re.compile(r"[-−+±(≤≥]?\d|–?$")
#: letters on a line where nobody sees it: of sentences, of tables; most of sentences; least of all
_SENTENCES, _PIPED, _MOST_OF_SENTENCES, _LEAST = 80, 200, 100, 40
#: what stands before a command
_CURE = "; cure: "
#: the option of every verb that runs or writes a scenario of a robot
ROBOT = typer.Option(
    None,
    "--robot",
    metavar="FILE",
    help="File of a robot, from which parameters follow (simcompare robot --template).",
)


def print_json(value: object) -> None:
    """Prints exactly one JSON object to stdout."""
    print_wanted(json.dumps(value, ensure_ascii=False, allow_nan=False))


def print_wanted(text: str | bytes, *, nl: bool = True) -> None:
    """Prints text that was asked for, such as a script, also where all else is quiet."""
    typer.echo(text, file=manner.out(), nl=nl)


class Rows:
    """A table that grows row by row.

    Args:
        heads: of its columns; what holds nothing but numbers stands at the right.
    """

    def __init__(self, *heads: str) -> None:
        self._heads = heads
        self._rows: list[tuple[str, ...]] = []

    def add_row(self, *cells: str) -> None:
        """Adds a row; cells may have several lines, those at the end may be left away."""
        self._rows.append((*cells, *[""] * (len(self._heads) - len(cells))))

    @property
    def table(self) -> Table:
        """All of it."""
        from simcompare.reports.render.tables import Column, Group, Table

        columns = zip(*self._rows, strict=True) if self._rows else [()] * len(self._heads)
        heads = [
            Column(head, text=not all(map(_NUMBER.match, cells)))
            for head, cells in zip(self._heads, columns, strict=True)
        ]
        return Table("", (*heads,), (Group("", (*self._rows,)),))


def show_table(made: Table | Rows) -> None:
    """Prints a table to stdout, all of its columns however wide the terminal is."""
    from simcompare.reports.render.text_tables import lines

    for line in lines(made.table if isinstance(made, Rows) else made, table_width()):
        typer.echo(line)


def width() -> int:
    """Letters on a line of sentences: those of the terminal, or as many as read well."""
    return min(_columns(_SENTENCES), _MOST_OF_SENTENCES)


def table_width() -> int:
    """Letters on a line of a table: those of the terminal, many in a pipe or file."""
    return _columns(_PIPED)


def _columns(unseen: int) -> int:
    """What COLUMNS says, or the terminal; ``unseen`` where there is none."""
    return max(shutil.get_terminal_size((unseen, 24)).columns, _LEAST)


def print_wrapped(sentences: Iterable[str]) -> None:
    """Sentences one below the other, lines that go on indented."""
    for sentence in sentences:
        fault, cure, command = sentence.partition(_CURE)
        text = fault + cure
        for plain, unbroken in _UNBROKEN.items():
            text = text.replace(plain, unbroken)
        further = " " * (len(text) - len(text.lstrip(" ")) + 2)
        for line in textwrap.wrap(
            text, width(), subsequent_indent=further, break_long_words=False,
            break_on_hyphens=False,
        ):  # fmt: skip
            typer.echo(line.replace(_TIED, " "))
        if command:  # on a line of its own, however long: it is there to be copied
            typer.echo(f"  {command}")


@contextmanager
def progress_bar(what: str) -> Iterator[Progress | None]:
    """A progress bar on stderr, nothing where stderr is not a terminal."""
    if manner.is_quiet() or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    stream = streams.Steering(sys.stderr)
    with Progress(*columns, console=Console(file=cast("IO[str]", stream)), transient=True) as bar:
        task = bar.add_task(what, total=None)

        def update(engine: str, done: int, total: int) -> None:
            said = streams.escaped(f"{what}: {engine}")
            bar.update(task, description=said, completed=done, total=total)

        yield update


#: between one parameter=value and another
_NEXT = re.compile(r"[,;]\s*(?=[A-Za-z][\w.]*\s*=)")


def pairs(
    settings: list[str], where: str = "--set", form: str = "parameter=value"
) -> dict[str, str | float]:
    """Reads arguments of the form parameter=value, such as those of ``--set``."""
    values: dict[str, str | float] = {}
    faults = []
    for text in settings:
        name, equals, value = text.partition("=")
        if not equals or not name.strip() or not value.strip():
            faults.append(f"{text!r} is not of the form {form}")
        elif _NEXT.search(value):
            each = " ".join(f"{where} {one.strip()}" for one in re.split(_NEXT, text))
            faults.append(f"{text!r} holds several; write {each}")
        elif name.strip() in values:
            faults.append(f"{name.strip()} is given twice")
        else:
            values[name.strip()] = value.strip()
    if faults:
        raise InputError(where, faults)
    return values
