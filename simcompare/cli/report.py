"""``simcompare report``."""

from __future__ import annotations

from pathlib import Path

import typer

from simcompare.cli import complete, console, opening

FORMATS = ("html", "pdf", "md", "png", "svg", "gif", "mp4")


def report(
    runs: list[Path] = typer.Argument(
        None, help="Folders of stored runs; the newest run in the folder runs by default."
    ),
    format: str = typer.Option(
        "html",
        help="html, pdf (all of it on paper), md (its tables), png or svg (its figures),"
        " gif or mp4 (the scene as a film).",
        autocompletion=lambda: list(FORMATS),
    ),
    out: Path = typer.Option(
        None,
        "--out",
        "-o",
        help="File to write (a folder for png and svg); beside the first run by default.",
    ),
    contact: str = typer.Option(
        None, help="Contact level that a film shows.", autocompletion=complete.contact_levels
    ),
    opened: bool = opening.OPTION,
) -> None:
    """Write the report of stored runs, or the film of one."""
    from simcompare.verbs import report as verb
    from simcompare.verbs import runs as stored

    places = [*runs] if runs else [stored.newest("runs")]
    with console.progress_bar("report") as progress:
        written = verb.report(places, format=format, out=out, contact=contact, progress=progress)
    typer.echo(str(written))
    if opened:
        opening.open_page(written)
