"""``simcompare gauge``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, ending, manner

if TYPE_CHECKING:
    from simcompare.verbs.gauge import Gauged


def gauge(
    examples: list[str] = typer.Argument(
        None,
        help="Names of worked examples; all of them where none is given.",
        autocompletion=complete.worked_examples,
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON list."),
) -> None:
    """Recompute worked examples, and say which digits agree."""
    from simcompare.model.plain import plain
    from simcompare.verbs import gauge as verb

    result = verb.gauge(examples or "all")
    ending.finish(
        lambda: [plain(row) for row in result.rows],
        lambda: _show(result),
        result.exit_code,
        as_json=as_json,
    )


def _show(result: Gauged) -> None:
    """The answer, the table, why some numbers are off, and what the words mean."""
    from simcompare.reports.gauge import tables, words

    console.print_wrapped([words.answer(result.outcomes)])
    typer.echo()
    console.show_table(tables.of(result.outcomes))
    typer.echo()
    console.print_wrapped([*words.notes(result.outcomes), *words.legend()])
    if manner.is_verbose():
        console.print_wrapped(words.sources(result.outcomes))
