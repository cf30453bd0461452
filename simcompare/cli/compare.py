"""``simcompare compare``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import console, manner, opening

if TYPE_CHECKING:
    from simcompare.model.plain import Plain
    from simcompare.verbs.compare import Comparison

#: in place of a measure
ALL = "all"


def compare(
    runs: list[Path] = typer.Argument(help="Folders of stored runs, or a folder that holds them."),
    measure: str = typer.Option(
        None, help="What is compared, 'all' for all; what the scenario asks for by default."
    ),
    csv: Path = typer.Option(None, "--csv", help="Write every value, a row each, to this file."),
    out: Path = typer.Option(
        None, "--out", "-o", help="File of the page; beside the runs by default."
    ),
    report: bool = typer.Option(True, help="Write the page with table and figure."),
    opened: bool = opening.OPTION,
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Put stored runs beside each other in a table and a figure."""
    from simcompare.verbs import compare as verb

    opening.check(opened, report=report)
    found = verb.compare(runs, None if measure == ALL else measure)
    # written before anything is printed: who reads a few lines alone has the files, too
    table = found.to_csv(csv) if csv is not None else None
    page = found.report(out) if report else None
    if as_json:
        console.print_json(_plain(found, page))
    else:
        _show(found, every=measure == ALL or manner.is_verbose())
        places = {"Table": table, "Page": page}
        for what, path in places.items():
            if path is not None:
                typer.echo(f"{what}: {path}")
    if opened:
        opening.open_page(page)


def _plain(found: Comparison, page: Path | None) -> Plain:
    from simcompare.reports.compare import words

    compared = found.compared
    return {
        "title": words.title(compared),
        "measure": found.measure,
        "measures": list(found.measures),
        "runs": [
            {
                "title": title,
                "folder": None if run.folder is None else str(run.folder),
                **{one.name: one.values[i] for one in compared.differences},
            }
            for i, (title, run) in enumerate(zip(compared.titles, compared.runs, strict=True))
        ],
        "notes": list(words.notes(compared)),
        "rows": found.scores.astype(object).where(found.scores.notna(), None).to_dict("records"),
        "page": None if page is None else str(page),
    }


def _show(found: Comparison, *, every: bool) -> None:
    from simcompare.reports.compare import tables, words
    from simcompare.reports.run import lead_table

    compared, width = found.compared, console.width()
    console.print_wrapped([words.title(compared), *words.short(compared, found.measure)])
    measures = found.measures if every else (found.measure,)
    shown = [table for name in measures for table in tables.tables(compared, name, width)]
    for table in shown:
        typer.echo("\n".join(["", *lead_table.text(table, width)]))
    typer.echo()
    console.print_wrapped([*words.legend(compared, shown), *words.notes(compared)])
    if not every and len(found.measures) > 1:
        others = ", ".join(name for name in found.measures if name != found.measure)
        console.print_wrapped([f"Also measured (--measure NAME, or all): {others}."])
