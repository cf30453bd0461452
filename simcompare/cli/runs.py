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
    from collections.abc import Sequence

    from simcompare.model.plain import Plain
    from simcompare.reports.render.tables import Table
    from simcompare.results.stored_runs import StoredRun

#: letters of a list of engines; more engines are counted
_ENGINES = 14
#: letters beside a name that a table needs to read well
_BESIDE = 56
#: what stands beside the name of a run
_HEADS = ("kind", "asked for", "engines", "verdict", "MB")


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
    """A table where there is room beside the names, else each name and below it the rest."""
    from simcompare.reports.render.tables import printable

    names, cells = [run.folder.name for run in found], list(map(_cells, found))
    if max(map(len, names)) + _BESIDE <= console.table_width():
        console.show_table(_table(names, cells))
        return
    for name, row in zip(names, cells, strict=True):
        typer.echo(printable(name))
        told = [cell for cell in (*row[:-1], f"{row[-1]}\u00a0MB") if not cell.startswith("–")]
        console.print_wrapped([f"  {printable(' · '.join(told))}"])


def _table(names: Sequence[str], cells: Sequence[Sequence[str]]) -> Table:
    from simcompare.reports.render.tables import Column, Group, Table

    *heads, size = _HEADS
    whole = [Column("run", text=True, nowrap=True)]
    columns = (*whole, *(Column(head, text=True) for head in heads), Column(size))
    rows = tuple((name, *row) for name, row in zip(names, cells, strict=True))
    return Table("", columns, (Group("", rows),))


def _cells(run: StoredRun) -> tuple[str, ...]:
    """What stands beside the name of a run."""
    if run.record is None:
        return ("–", run.fault, "–", run.verdict, "–")
    asked = ", ".join(map(_brief, run.asked)) or "–"
    if run.record.command is None:  # those of version 0.1 do not say
        asked = "not known"
    if run.record.scenario not in run.folder.name:  # the folder was given another name
        asked = f"{run.record.scenario}: {asked}"
    engines = ", ".join(run.engines) or "none"
    if len(engines) > _ENGINES:
        engines = f"{len(run.engines)} engines"
    return (run.record.kind, asked, engines, run.verdict, f"{run.size_bytes / 1e6:.1f}")


def _brief(asked: str) -> str:
    """Without the folders of a file, and without the word before a recording."""
    name, space, value = asked.partition(" ")
    value = Path(value).name if "/" in value else value
    return value if name == "recording" else f"{name}{space}{value}"


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
    from simcompare.results.stored_runs import RUNNING

    if run.is_running:
        console.print_wrapped([f"Kept: {run.folder} {RUNNING[True]}"])
        return
    if run.others:
        others = ", ".join(run.others)
        console.print_wrapped([f"Kept: {run.folder} holds files that are not ours: {others}"])
        return
    fault = RUNNING[None] if run.is_running is None else f"its run.json {run.fault}"
    console.print_wrapped([f"Kept: {run.folder}: {fault}. To delete it yourself:"])
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
