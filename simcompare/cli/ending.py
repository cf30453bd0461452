"""How a command ends: the report is written, the answer printed, and the exit code given."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import typer

from simcompare.cli import console, opening

if TYPE_CHECKING:
    from simcompare.model.plain import Plain
    from simcompare.reports.render.parts import Block
    from simcompare.results.run import Run

#: exit code of what Ctrl-C ended
INTERRUPTED = 130


def finish(
    plain: Callable[[], Plain | list[Plain]],
    show: Callable[[], None],
    exit_code: int,
    *,
    as_json: bool,
    page: Path | None = None,
) -> NoReturn:
    """Prints the answer, as JSON or for people, and ends the command.

    Args:
        plain: gives what ``--json`` prints.
        show: prints it for people.
        exit_code: with which the command ends.
        as_json: whether JSON is printed.
        page: what is opened in the browser, ``None`` for nothing.
    """
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
    page = _write_report(result) if report else None
    code = INTERRUPTED if result.record.interrupted else result.exit_code
    finish(plain, lambda: show(page), code, page=page if opened else None, as_json=as_json)


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
    page = _write_block(block, folder, figures, report=report)
    finish(plain, lambda: show(page), exit_code, page=page if opened else None, as_json=as_json)


def show_end(result: Run, page: Path | None) -> None:
    """Prints that a run was interrupted, where it is stored, and its report."""
    if result.record.interrupted:
        typer.echo("Interrupted: what had finished is kept.", err=True)
    show_places(result.folder, page)


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


def _write_report(result: Run) -> Path | None:
    from simcompare.reports import builder

    if result.folder is None:
        return None
    return builder.write_html([result], result.folder / "report.html")
