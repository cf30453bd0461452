"""How a command ends: the report is written, the answer printed, and the exit code given."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import typer

from simcompare.cli import console, opening, streams
from simcompare.errors import INTERRUPTED, OutputError, SimcompareError

if TYPE_CHECKING:
    from simcompare.model.plain import Plain
    from simcompare.reports.render.parts import Block
    from simcompare.results.run import Run


def finish(
    plain: Callable[[], Plain | list[Plain]],
    show: Callable[[], None],
    exit_code: int,
    *,
    as_json: bool,
    page: Path | None = None,
    note: str = "",
) -> NoReturn:
    """Prints the answer, as JSON or for people, and ends the command.

    Args:
        plain: gives what ``--json`` prints.
        show: prints it for people.
        exit_code: with which the command ends.
        as_json: whether JSON is printed.
        page: what is opened in the browser, ``None`` for nothing.
        note: said on stderr where stdout takes no more.
    """
    with streams.readers_may_leave(exit_code, note):
        if as_json:
            console.print_json(plain())
        else:
            show()
    opening.open_page(page)
    raise typer.Exit(exit_code)


def finish_run(
    result: Run,
    plain: Callable[[], Plain],
    show: Callable[[Path | None], None],
    *,
    report: bool,
    opened: bool,
    as_json: bool,
) -> NoReturn:
    """Ends a run, a fit or a validation.

    Args:
        result: what came out.
        plain: gives what ``--json`` prints.
        show: prints it for people; it is given the page of the report, ``None`` without one.
        report: whether report.html is written into the run's folder.
        opened: whether it is opened in the browser.
        as_json: whether JSON is printed.
    """
    code = INTERRUPTED if result.record.interrupted else result.exit_code
    if result.record.interrupted:
        typer.echo(_how_far(result), err=True)
    with _told_where(result.folder):
        page, fault = _written(result) if report else (None, None)
        try:
            finish(
                plain, lambda: show(page), code,
                page=page if opened else None, as_json=as_json, note=_stored(result.folder),
            )  # fmt: skip
        finally:
            if fault is not None:  # the answer is told all the same
                raise fault


def finish_block(
    block: Callable[[], Block],
    folder: Path | None,
    plain: Callable[[], Plain],
    show: Callable[[Path | None], None],
    exit_code: int = 0,
    *,
    report: bool,
    opened: bool,
    as_json: bool,
    figures: str | None = None,
) -> NoReturn:
    """Ends a command whose result is shown in one block.

    Args:
        block: makes what is shown.
        folder: of the result.
        plain: gives what ``--json`` prints.
        show: prints it for people; it is given the last file that was written, ``None`` for none.
        exit_code: with which the command ends.
        report: whether report.html is written.
        opened: whether it is opened in the browser.
        as_json: whether JSON is printed.
        figures: format of files of the figures, ``None`` for none.
    """
    with _told_where(folder):
        page = _write_block(block, folder, figures, report=report)
        finish(
            plain, lambda: show(page), exit_code,
            page=page if opened else None, as_json=as_json, note=_stored(folder),
        )  # fmt: skip


def show_places(folder: Path | None, page: Path | None) -> None:
    """Prints where results are stored, and their report."""
    if folder is not None:
        typer.echo(f"Stored in {folder}")
    if page is not None:
        typer.echo(f"Report: {page}")


def _write_block(
    block: Callable[[], Block], folder: Path | None, figures: str | None, *, report: bool
) -> Path | None:
    """Writes what is shown into the folder; gives the last file, ``None`` for none."""
    from simcompare.reports import builder

    assert folder is not None
    files = []
    if figures is not None:
        files += builder.write_figures_of([block()], folder / "figures", figures)
    if report:
        files.append(builder.write_html_of([block()], folder / "report.html"))
    return files[-1] if files else None


def _written(result: Run) -> tuple[Path | None, SimcompareError | None]:
    """The page of a report, or why it could not be written."""
    from simcompare.reports import builder

    if result.folder is None:
        return None, None
    try:
        return builder.write_html([result], result.folder / "report.html"), None
    except OutputError as error:
        return None, OutputError(f"{error}\n{_stored(result.folder)}; {_later(result.folder)}")


@contextmanager
def _told_where(folder: Path | None) -> Iterator[None]:
    """Ctrl-C, when all is stored already, says so."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_stored(folder)) from None


def _stored(folder: Path | None) -> str:
    return "" if folder is None else f"stored in {folder}"


def _later(folder: Path) -> str:
    return f"its report can be made later: {shlex.join(['simcompare', 'report', str(folder)])}"


def _how_far(result: Run) -> str:
    """What an interrupted run has kept, and how to go on with it."""
    sources, repeats = result.record.sources, result.record.repeats
    done = f"{sum(source.repeats for source in sources)} of {len(sources) * repeats}"
    told = f"simcompare: interrupted; {done} simulations had finished"
    if result.folder is None:
        return told
    from simcompare.results import unfinished

    return f"{told} and are kept; go on with: {unfinished.resuming(result.folder)}"
