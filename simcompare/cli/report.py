"""``simcompare report``."""

from __future__ import annotations

from pathlib import Path

import typer

from simcompare.cli import opening
from simcompare.errors import UnknownName

FORMATS = ("html", "pdf", "md", "png", "svg")


def report(
    runs: list[Path] = typer.Argument(help="Folders of stored runs."),
    format: str = typer.Option(
        "html",
        help="html, pdf (report with all figures), md, png or svg (the figures alone).",
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
    """Write a comparison report from stored runs."""
    from simcompare.reports import builder
    from simcompare.results import store

    if format not in FORMATS:
        raise UnknownName("format", format, FORMATS)
    loaded = [store.load(path) for path in runs]
    if format in ("png", "svg"):
        written = builder.write_figures(loaded, out or runs[0] / "figures", format)
    else:
        path = out or runs[0] / f"report.{format}"
        write = {
            "html": builder.write_html,
            "pdf": builder.write_pdf,
            "md": builder.write_markdown,
        }[format]
        written = [write(loaded, path)]
    for file in written:
        typer.echo(str(file))
    if opened:
        opening.open_page(written[0])
