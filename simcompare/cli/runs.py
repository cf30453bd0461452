"""``simcompare runs``."""

from __future__ import annotations

import contextlib
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import console
from simcompare.errors import InputError

if TYPE_CHECKING:
    from simcompare.model.plain import Plain
    from simcompare.results.stored_runs import StoredRun

#: letters of a list of engines, of their number alone, and between columns
_ENGINES, _COUNTED, _GUTTER = 14, 7, 2
#: letters of what was asked for that read well, and that are left at least
_GOOD_ASKED, _MIN_ASKED = 20, 8


def runs(
    folder: Path = typer.Argument(Path("runs"), help="Folder in which the runs lie."),
    clean: bool = typer.Option(False, "--clean", help="Delete old runs; asks first."),
    older_than: str = typer.Option(None, help="With --clean: only runs older than this, as 30d."),
    keep: int = typer.Option(None, help="With --clean: keep so many of the newest."),
    yes: bool = typer.Option(False, "--yes", "-y", help="With --clean: do not ask."),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """List stored runs, the newest first, or delete old ones."""
    from simcompare.verbs import runs as verb

    given = {"--older-than": older_than is not None, "--keep": keep is not None, "--yes": yes}
    if not clean and any(given.values()):
        alone = " and ".join(flag for flag, is_given in given.items() if is_given)
        raise InputError(alone, ["deletes nothing without --clean"])
    found = verb.runs(folder)
    going = verb.to_clean(found, older_than=older_than, keep=keep) if clean else []
    if clean:
        _clean(folder, found, going, yes=yes, as_json=as_json)
    elif as_json:
        console.print_json({"runs": [_plain(run) for run in found]})
    else:
        _show(folder, found)


def _plain(run: StoredRun) -> Plain:
    record = run.record
    return {
        "folder": str(run.folder),
        "created": run.created,
        "kind": "" if record is None else record.kind,
        "scenario": "" if record is None else record.scenario,
        "asked": list(run.asked),
        "engines": list(run.engines),
        "verdict": run.verdict,
        "size_bytes": run.size_bytes,
        "fault": run.fault,
        "others": list(run.others),
    }


def _show(folder: Path, found: list[StoredRun]) -> None:
    if not found:
        typer.echo(f"{folder} holds no runs. Make one: simcompare run ball")
        return
    _show_rows(found)
    typer.echo(f"{folder} holds {_count(found)}")


def _show_rows(found: list[StoredRun]) -> None:
    """One line a run; what is too long ends with …, and a last line says where it stands whole."""
    from simcompare.reports.render.tables import printable

    heads = ("run", "kind", "asked for", "engines", "verdict", "MB")
    for letters in (_ENGINES, _COUNTED):
        rows = [heads, *(tuple(map(printable, _cells(run, letters))) for run in found)]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        over = sum(widths) + _GUTTER * (len(heads) - 1) - console.width()
        if over <= max(widths[2] - _GOOD_ASKED, 0):
            break
    for column in (2, 0):
        less = min(max(over, 0), max(widths[column] - _MIN_ASKED, 0))
        widths[column], over = widths[column] - less, over - less
    for cells in rows:
        *words, size = map(_shortened, cells, widths)
        texts = [text.ljust(width) for text, width in zip(words, widths[:-1], strict=True)]
        typer.echo((" " * _GUTTER).join([*texts, size.rjust(widths[-1])]))
    if any(len(cell) > width for cells in rows for cell, width in zip(cells, widths, strict=True)):
        console.print_wrapped(["…: cut off; a wider window shows more, --json all."])


def _cells(run: StoredRun, letters: int) -> tuple[str, ...]:
    """A line of the list; more engines than so many letters hold are counted."""
    name, size = run.folder.name, f"{run.size_bytes / 1e6:.1f}"
    if run.record is None:
        return (name, "–", run.fault, "–", run.verdict, size)
    asked = ", ".join(map(_brief, run.asked)) or "–"
    if run.record.command is None:  # those of version 0.1 do not say
        asked = "not known"
    if run.record.scenario not in name:  # the folder was given another name
        asked = f"{run.record.scenario}: {asked}"
    engines = ", ".join(run.engines) or "none"
    if len(engines) > letters:
        engines = f"{len(run.engines)} engines"
    return (name, run.record.kind, asked, engines, run.verdict, size)


def _brief(asked: str) -> str:
    """Without the folders of a file, and without the word before a recording."""
    name, space, value = asked.partition(" ")
    value = Path(value).name if "/" in value else value
    return value if name == "recording" else f"{name}{space}{value}"


def _shortened(text: str, width: int) -> str:
    return text if len(text) <= width else f"{text[: width - 1]}…"


def _size(size_bytes: int) -> str:
    return f"{size_bytes / 1e6:.1f} MB"


def _clean(
    folder: Path,
    found: list[StoredRun],
    going: list[StoredRun],
    *,
    yes: bool,
    as_json: bool,
) -> None:
    from simcompare.results import stored_runs

    if going and not yes:
        with contextlib.redirect_stdout(sys.stderr):  # the list is part of the question
            _announce(folder, found, going)
        going = going if _agreed(f"Delete {_count(going)}? They cannot be brought back.") else []
    elif not as_json:
        _announce(folder, found, going)
    stored_runs.delete(going)
    if as_json:
        console.print_json({"deleted": [_plain(run) for run in going]})
    elif going:
        typer.echo("Deleted.")


def _announce(folder: Path, found: list[StoredRun], going: list[StoredRun]) -> None:
    """What is to be deleted, and what is not ours to delete."""
    from simcompare.results.stored_runs import can_go

    if going:
        _show_rows(going)
    typer.echo(f"To delete in {folder}: {_count(going)}, of {_count(found)}")
    for run in found:
        if not can_go(run):
            _keep(run)


def _keep(run: StoredRun) -> None:
    """Says why a run stays, and what deletes it all the same."""
    if run.record is not None:
        others = ", ".join(run.others)
        console.print_wrapped([f"Kept: {run.folder} holds files that are not ours: {others}"])
        return
    console.print_wrapped([f"Kept: {run.folder}: its run.json {run.fault}. To delete it yourself:"])
    typer.echo(f"  rm -r {shlex.quote(str(run.folder))}")


def _count(runs: list[StoredRun]) -> str:
    size = _size(sum(run.size_bytes for run in runs))
    return f"{len(runs)} {'run' if len(runs) == 1 else 'runs'}, {size}"


def _agreed(question: str) -> bool:
    """Whether the user says yes; an error where nobody can be asked."""
    try:
        agreed = typer.confirm(question, err=True)
    except typer.Abort:
        typer.echo(err=True)  # the question still stands on the line
        raise InputError("--clean", ["nobody answered, nothing was deleted; add --yes"]) from None
    if not agreed:
        typer.echo("Nothing was deleted.", err=True)
    return agreed
