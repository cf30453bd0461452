"""Printing for people: numbers with their uncertainty, progress on stderr."""

from __future__ import annotations

import json
import shutil
import sys
import textwrap
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import typer

from simcompare.cli import manner
from simcompare.errors import InputError

if TYPE_CHECKING:
    from simcompare.running.runner import Progress


#: what stands on both sides of it stays on one line
_TIED = "\u00a0"
#: such as a value and its scatter
_UNBROKEN = {" ± ": f"{_TIED}±{_TIED}", "(± ": f"(±{_TIED}"}
#: what stands before a command
_CURE = "; cure: "


def print_json(value: object) -> None:
    """Prints exactly one JSON object to stdout."""
    print_wanted(json.dumps(value, ensure_ascii=False, allow_nan=False))


def print_wanted(text: str | bytes, *, nl: bool = True) -> None:
    """Prints text that was asked for, such as a script, also where all else is quiet."""
    typer.echo(text, file=manner.out(), nl=nl)


def table(*columns: str) -> Any:  # noqa: ANN401
    """An empty rich table with these columns."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    grid = Table(box=SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        grid.add_column(column, overflow="fold")
    return grid


def show_table(grid: Any) -> None:  # noqa: ANN401
    """Prints a table to stdout; colours obey NO_COLOR and are left out of pipes."""
    from rich.console import Console

    width = None if sys.stdout.isatty() else 140
    Console(width=width, markup=False).print(grid)  # a unit in brackets is no markup


def width() -> int:
    """Letters on a line: those of the terminal, 80 where nobody sees one."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else 80


def print_wrapped(sentences: Iterable[str]) -> None:
    """Sentences one below the other, lines that go on indented."""
    for sentence in sentences:
        fault, cure, command = sentence.partition(_CURE)
        text = fault + cure
        for plain, unbroken in _UNBROKEN.items():
            text = text.replace(plain, unbroken)
        for line in textwrap.wrap(
            text, width(), subsequent_indent="  ", break_long_words=False, break_on_hyphens=False
        ):
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
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)

        def update(engine: str, done: int, total: int) -> None:
            bar.update(task, description=f"{what}: {engine}", completed=done, total=total)

        yield update


def pairs(settings: list[str], where: str = "--set") -> dict[str, str | float]:
    """Reads arguments of the form parameter=value, such as those of ``--set``."""
    values: dict[str, str | float] = {}
    for text in settings:
        name, equals, value = text.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise InputError(where, [f"{text!r} is not of the form parameter=value"])
        if name.strip() in values:
            raise InputError(where, [f"{name.strip()} is given twice"])
        values[name.strip()] = value.strip()
    return values
