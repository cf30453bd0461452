"""The verb ``report``: pages, documents and figures from runs."""

from __future__ import annotations

import contextlib
import functools
import webbrowser
from collections.abc import Sequence
from pathlib import Path

from simcompare.arguments import checked
from simcompare.errors import InputError, UnknownName
from simcompare.reports import builder
from simcompare.reports.render import film
from simcompare.results import store
from simcompare.results.run import Run
from simcompare.running.runner import Progress
from simcompare.verbs.damaged import told_as_damaged

#: formats of a document, and those of single figures; films are of what moves
DOCUMENTS, FIGURES = ("html", "pdf", "md"), ("png", "svg")
FORMATS = (*DOCUMENTS, *FIGURES, *film.FORMATS)

_FILMS = " and ".join(film.FORMATS)

Source = Run | str | Path


@checked
def report(
    runs: Source | Sequence[Source],
    *,
    format: str = "html",
    out: str | Path | None = None,
    contact: str | None = None,
    open: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Writes a report of runs, fits or validations, or the scene of one as a film.

    ::

        run = simcompare.run("ball")
        simcompare.report(run, open=True)
        simcompare.report("runs/20260101-120000-ball", format="pdf", out="ball.pdf")
    simcompare.report(run, format="gif", contact="tuned")

    Args:
        runs: a run or the folder of a stored one, or several of them.
        format: "html", "pdf" or "md"; "png" or "svg" for the figures alone; "gif" or "mp4" for
            the scene as a film.
        out: file to write, of figures the folder; beside the first run where ``None``, and in
            the current folder where that is not stored.
        contact: level that a film shows; that which a report shows first where ``None``.
        open: whether the browser shows it.
        progress: is called with (what, done, total) after each picture of a film.

    Returns:
        The file, or the folder of the figures.

    Raises:
        UnknownName: another format; a contact level that the run does not have.
        InputError: no run, or a folder that holds none; nothing that moves, or no ffmpeg.
        OutputError: it cannot be written.
    """
    if format not in FORMATS:
        raise UnknownName("format", format, FORMATS)
    if contact is not None and format not in film.FORMATS:
        raise InputError(
            "--contact", [f"{format} shows all levels; a level is chosen for {_FILMS} alone"]
        )
    listed = [runs] if isinstance(runs, Run | str | Path) else [*runs]
    if not listed:
        raise InputError("report", ["no run is given; expected at least one"])
    if format in film.FORMATS and len(listed) > 1:
        raise InputError("report", [f"{len(listed)} runs are given; a film shows one"])
    stored = [str(one) for one in listed if not isinstance(one, Run)]
    loaded = [one if isinstance(one, Run) else store.load(Path(one)) for one in listed]
    place = _place(loaded[0], format) if out is None else Path(out)
    with told_as_damaged(stored, "report"):
        if format in film.FORMATS:
            told = functools.partial(progress or _silent, "film")
            written = builder.write_film(loaded[0], place, format, contact, told)
        else:
            written = _written(loaded, format, place)
    if open:
        with contextlib.suppress(webbrowser.Error):  # where there is none the file is told
            webbrowser.open(written.resolve().as_uri())
    return written


def _place(run: Run, format: str) -> Path:
    """Where the report lies if nothing is said."""
    stem = "film" if format in film.FORMATS else "report"
    name = "figures" if format in FIGURES else f"{stem}.{format}"
    return Path(f"{run.record.scenario}-{name}") if run.folder is None else run.folder / name


def _silent(_what: str, _done: int, _total: int) -> None:
    """Nobody watches."""


def _written(runs: Sequence[Run], format: str, place: Path) -> Path:
    if format in FIGURES:
        builder.write_figures(runs, place, format)
        return place
    write = {
        "html": builder.write_html, "pdf": builder.write_pdf, "md": builder.write_markdown,
    }[format]  # fmt: skip
    return write(runs, place)
