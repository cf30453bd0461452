"""The verb ``report``: pages, documents and figures from runs."""

from __future__ import annotations

import contextlib
import webbrowser
from collections.abc import Sequence
from pathlib import Path

from simcompare.arguments import checked
from simcompare.errors import InputError, UnknownName
from simcompare.reports import builder
from simcompare.results import store
from simcompare.results.run import Run
from simcompare.verbs.damaged import told_as_damaged

#: formats of a document, and those of single figures
DOCUMENTS, FIGURES = ("html", "pdf", "md"), ("png", "svg")
FORMATS = (*DOCUMENTS, *FIGURES)

Source = Run | str | Path


@checked
def report(
    runs: Source | Sequence[Source],
    *,
    format: str = "html",
    out: str | Path | None = None,
    open: bool = False,
) -> Path:
    """Writes a report of runs, fits or validations.

    ::

        run = simcompare.run("ball")
        simcompare.report(run, open=True)
        simcompare.report("runs/20260101-120000-ball", format="pdf", out="ball.pdf")

    Args:
        runs: a run or the folder of a stored one, or several of them.
        format: "html", "pdf" or "md"; "png" or "svg" for the figures alone.
        out: file to write, of figures the folder; beside the first run where ``None``, and in
            the current folder where that is not stored.
        open: whether the browser shows it.

    Returns:
        The file, or the folder of the figures.

    Raises:
        UnknownName: another format.
        InputError: no run, or a folder that holds none.
        OutputError: it cannot be written.
    """
    if format not in FORMATS:
        raise UnknownName("format", format, FORMATS)
    listed = [runs] if isinstance(runs, Run | str | Path) else [*runs]
    if not listed:
        raise InputError("report", ["no run is given; expected at least one"])
    stored = [str(one) for one in listed if not isinstance(one, Run)]
    loaded = [one if isinstance(one, Run) else store.load(Path(one)) for one in listed]
    place = _place(loaded[0], format) if out is None else Path(out)
    with told_as_damaged(stored, "report"):
        written = _written(loaded, format, place)
    if open:
        with contextlib.suppress(webbrowser.Error):  # where there is none the file is told
            webbrowser.open(written.resolve().as_uri())
    return written


def _place(run: Run, format: str) -> Path:
    """Where the report lies if nothing is said."""
    name = "figures" if format in FIGURES else f"report.{format}"
    return Path(f"{run.record.scenario}-{name}") if run.folder is None else run.folder / name


def _written(runs: Sequence[Run], format: str, place: Path) -> Path:
    if format in FIGURES:
        builder.write_figures(runs, place, format)
        return place
    write = {
        "html": builder.write_html, "pdf": builder.write_pdf, "md": builder.write_markdown,
    }[format]  # fmt: skip
    return write(runs, place)
