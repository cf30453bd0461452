"""``simcompare report``."""

from __future__ import annotations

from pathlib import Path

import typer

from simcompare.cli import opening

FORMATS = ("html", "pdf", "md", "png", "svg")


def report(
    runs: list[Path] = typer.Argument(
        None, help="Folders of stored runs; the newest run in the folder runs by default."
    ),
    format: str = typer.Option(
        "html",
        help="html, pdf (all of it on paper), md (its tables), png or svg (its figures).",
        autocompletion=lambda: list(FORMATS),
    ),
    out: Path = typer.Option(
        None,
        "--out",
        "-o",
        help="File to write (a folder for png and svg); beside the first run by default.",
    ),
    opened: bool = opening.OPTION,
) -> None:
    """Write the report of one stored run, or of several."""
    from simcompare.verbs import report as verb
    from simcompare.verbs import runs as stored

    places = [*runs] if runs else [stored.newest("runs")]
    written = verb.report(places, format=format, out=out)
    typer.echo(str(written))
    if opened:
        opening.open_page(written)
