"""What ``simcompare validate`` prints of a table of results."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

import typer

from simcompare import glossary
from simcompare.cli import console, ending, manner
from simcompare.model.plain import plain
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import printable
from simcompare.reports.tabled import page, tables, words
from simcompare.results.records.tabled import TableValidation


def finish(found: TableValidation, *, report: bool, opened: bool, as_json: bool) -> NoReturn:
    """Writes the report, prints the answer, and ends the command."""
    ending.finish_block(
        lambda: page.block_of(found),
        found.folder,
        lambda: {**plain(found), "exit_code": found.exit_code},
        lambda file: _show(found, file),
        found.exit_code,
        report=report,
        opened=opened,
        as_json=as_json,
    )


def _show(found: TableValidation, file: Path | None) -> None:
    """The answer, the verdicts, what was assumed, and every row where it is wanted."""
    console.print_wrapped(numbers.tied(printable(text)) for text in words.sentences(found))
    typer.echo("")
    console.show_table(tables.verdicts(found))
    for result in found.results if manner.is_verbose() else ():
        for table in filter(None, (tables.rows(result), tables.told(result))):
            typer.echo(f"\n{table.title}")
            console.show_table(table)
    typer.echo("")
    console.print_wrapped(printable(f"Did not run: {why}") for why in words.not_run(found))
    console.print_wrapped(printable(f"{note.rstrip('.')}.") for note in words.notes(found))
    console.print_wrapped(glossary.legend(words.WORDS))
    ending.show_places(found.folder, file)
