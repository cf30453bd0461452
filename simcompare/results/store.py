"""A run on disk: ``runs/<id>/{run.json, trajectories.parquet, scores.csv}``.

A run is written into a hidden folder beside its place and put there when it is complete, so a full
disk or Ctrl-C leaves nothing half-written behind. run.json tells the digest of each table.
"""

from __future__ import annotations

import contextlib
import csv
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from simcompare.comparison.comparison import Score
from simcompare.errors import InputError, NoSuchFile, OutputError
from simcompare.model import cells, parquet, plain, user_file, whole
from simcompare.model.parquet import Table
from simcompare.model.settings import OLD_LEVELS
from simcompare.model.trajectory import Array, Trajectory
from simcompare.results import readings_file, unfinished, zones_file
from simcompare.results.records.run import Record
from simcompare.results.run import Run, Stored
from simcompare.results.unfinished import Unfinished

AnyRun = TypeVar("AnyRun", bound=Run)

RECORD, TRAJECTORIES, SCORES = "run.json", "trajectories.parquet", "scores.csv"
#: stored runs that are named where one must be chosen
_LISTED = 5
#: columns that say whose sample a row is
_INDEX = ("source", "contact", "repeat", "parameters", "segment")
#: those that version 0.1 did not have
_NEW = ("parameters", "segment")


def check_writable(folder: Path) -> None:
    """Makes the output folder and proves that it can be written to, before anything is simulated.

    Raises:
        OutputError: it cannot.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        whole.probe(folder)
    except OSError as error:
        raise OutputError(
            f"--out {folder}: cannot be written to ({error.strerror}); choose another folder"
        ) from None


def save(
    run: AnyRun,
    folder: Path,
    more: Mapping[str, str] | None = None,
    begun: Unfinished | None = None,
) -> AnyRun:
    """Writes a run below ``folder`` and returns it with its place filled in.

    Args:
        run: what was found.
        folder: in which its own folder is made.
        more: texts that are stored with it, by the names of their files.
        begun: the folder that was made for it when it began, which it replaces. Where the run
            was interrupted, what was kept in it goes along.

    Raises:
        OutputError: it cannot be written; nothing is left behind, but what was begun.
    """
    with new_folder(folder, run.record.created, run.record.scenario, begun=begun) as made:
        place, partial = made
        tables = {
            **_write_trajectories(partial, run.trajectories),
            **readings_file.save(run, partial),
            **zones_file.save(run, partial),
        }
        record = replace(run.record, run=str(place), tables=tables)
        _write_scores(partial / SCORES, run.record.scores)
        for name, text in (more or {}).items():
            (partial / name).write_text(text, encoding="utf-8")
        (partial / RECORD).write_text(plain.text(record, indent=1) + "\n", encoding="utf-8")
        if begun is not None:
            begun.carry(partial, parts=run.record.interrupted)
    return replace(run, record=record, folder=place)


@contextlib.contextmanager
def new_folder(
    folder: Path, created: str, name: str, what: str = "run", begun: Unfinished | None = None
) -> Iterator[tuple[Path, Path]]:
    """A free place for results, and the hidden folder to write them in, which is then put there.

    Args:
        folder: in which both lie.
        created: date and time, ISO 8601.
        name: what the place is called after the time.
        what: what is written, for the message.
        begun: the place, where it was made before.

    Raises:
        OutputError: it cannot be written; nothing is left behind.
    """
    lost = " nothing was kept," if begun is None else ""
    try:
        with contextlib.ExitStack() as stack:
            if begun is None:
                begun = stack.enter_context(
                    contextlib.closing(unfinished.reserve(folder, created, name))
                )
                stack.callback(begun.drop_empty)
            with whole.folder(begun.folder) as partial:
                yield begun.folder, partial
    except OSError as error:
        raise OutputError(
            f"{folder}: the {what} cannot be written ({error.strerror or error});{lost}"
            " free some space or choose another --out"
        ) from None


def load(place: str | Path) -> Run:
    """Reads a stored run.

    Args:
        place: its folder, or run.json in it.

    Raises:
        InputError: there is none, or its files are damaged; names the file.
    """
    run = load_record(place)
    assert run.folder is not None
    trajectories = _read_trajectories(run.folder / TRAJECTORIES, run.record)
    again = _again(run.record)
    readings = readings_file.load(run.record, run.folder, again)
    readings += zones_file.load(run.record, run.folder, again)
    return replace(run, trajectories=tuple(trajectories), stored_readings=readings)


def load_record(place: str | Path) -> Run:
    """Reads a stored run without its trajectories.

    Args:
        place: its folder, or run.json in it.

    Raises:
        InputError: there is none, or run.json is damaged; names the file.
    """
    named = Path(place)
    place = named.parent if named.name == RECORD else named
    path = place / RECORD
    if not path.is_file():
        raise _no_run(named)
    from simcompare.results.records import stored  # fits and validations are read nowhere else

    return Run(
        stored.read(path, (TRAJECTORIES, readings_file.READINGS, zones_file.ZONES)), (), place
    )


def _no_run(place: Path) -> InputError:
    """What is wrong with a place that holds no run, and the runs that lie in it."""
    if not place.is_dir():
        return NoSuchFile(place, "the folder of a stored run")
    if unfinished.is_unfinished(place):
        fault = f"was ended before it was complete; go on with: {unfinished.resuming(place)}"
        return InputError(str(place), [fault])
    if (place / RECORD).is_dir():
        raise InputError(str(place / RECORD), ["is a folder; expected a file"])
    user_file.check_is_stored(place / RECORD)
    inside = sorted(path.parent for path in place.glob(f"*/{RECORD}"))
    fault = f"is not a stored run: it holds no {RECORD}"
    if inside:
        listed = "".join(f"\n  {path}" for path in inside[: -1 - _LISTED : -1])
        what = (
            "a stored run; name it"
            if len(inside) == 1
            else (f"{len(inside)} stored runs; name one of them, such as the newest")
        )
        fault = f"holds {what}:{listed}"
    return InputError(str(place), [fault])


def _write_scores(path: Path, scores: tuple[Score, ...]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(field.name for field in fields(Score))
        writer.writerows(map(cells.cell, vars(score).values()) for score in scores)


def _write_trajectories(folder: Path, entries: tuple[Stored, ...]) -> dict[str, Table]:
    """One table: whose sample it is, time, and one column per component.

    Raises:
        OSError: DuckDB could not write; its own message is kept.
    """
    if not entries:
        return {}
    blocks = [item.trajectory.to_columns() for item in entries]
    names = list(dict.fromkeys(name for block in blocks for name in block))
    lengths = [len(item.trajectory.time_s) for item in entries]
    table = {
        "entry": np.repeat(np.arange(len(entries)), lengths),
        **{name: _column(blocks, lengths, name) for name in names},
    }
    labels = [(i, *(getattr(item, name) for name in _INDEX)) for i, item in enumerate(entries)]
    row = f"({', '.join('?' * (1 + len(_INDEX)))})"
    index = ", ".join(_INDEX)
    with parquet.connect() as connection:
        _, *columns = parquet.register(connection, "samples", table)
        connection.execute(
            "create table labels as from"
            f" (values {', '.join([row] * len(labels))}) t(entry, {index})",
            [value for label in labels for value in label],
        )
        query = (
            f"select {index}, {', '.join(columns)} from samples join labels"
            " on samples.c0 = labels.entry order by entry, time_s"
        )
        return {TRAJECTORIES: parquet.write(connection, query, folder / TRAJECTORIES)}


def _column(blocks: list[dict[str, Array]], lengths: list[int], name: str) -> Array:
    empty = [np.full(length, np.nan) for length in lengths]
    return np.concatenate([block.get(name, nan) for block, nan in zip(blocks, empty, strict=True)])


def _read_trajectories(path: Path, record: Record) -> list[Stored]:
    if TRAJECTORIES not in record.tables and not path.exists():
        return []
    columns = parquet.read(path, record.tables.get(TRAJECTORIES, Table()), _again(record))
    lacking = [name for name in (*_INDEX, "time_s") if name not in columns and name not in _NEW]
    if lacking:
        raise InputError(str(path), [f"is not of a run: it has no column {', '.join(lacking)}"])
    if not set(_NEW) <= set(columns):
        columns |= _new_columns(columns, record)
    _check_samples(path, columns)
    keys = list(zip(*(columns[name].tolist() for name in _INDEX), strict=True))
    signals = [name for name in columns if name not in _INDEX]
    starts = [i for i, key in enumerate(keys) if i == 0 or key != keys[i - 1]]
    if len(starts) > len(set(keys)):
        raise InputError(str(path), ["is damaged: the samples of a source do not stand together"])
    versions = {(source.name, source.contact): source.version or "" for source in record.sources}
    entries = []
    for start, end in zip(starts, [*starts[1:], len(keys)], strict=True):
        source, contact, repeat, parameters, segment = keys[start]
        contact = OLD_LEVELS.get(contact, contact)
        block = {name: columns[name][start:end] for name in signals}
        try:
            trajectory = _from_columns(source, contact, block)
        except ValueError as error:
            raise InputError(str(path), [f"is damaged at {source}, {contact}: {error}"]) from None
        trajectory = replace(trajectory, version=versions.get((source, contact), ""))
        entries.append(Stored(source, contact, repeat, trajectory, parameters, segment))
    return entries


def _again(record: Record) -> str:
    """What makes a run anew."""
    return f"run it again: {shlex.join(record.command)}" if record.command else "run it again"


def _check_samples(path: Path, columns: parquet.Columns) -> None:
    """Refuses a table without rows, or with something else than numbers where they belong.

    Raises:
        InputError: which columns, all of them.
    """
    numbers = {name for name in columns if name not in _INDEX} | {"repeat", "segment"}
    lengths = {len(values) for values in columns.values()}
    faults = [
        f"is damaged: its column {name} holds no numbers"
        for name, values in columns.items()
        if name in numbers and values.dtype.kind not in "fiu"
    ]
    if lengths != {len(columns["time_s"])} or not len(columns["time_s"]):
        faults.append("is damaged: it holds no samples")
    elif not faults and not np.isfinite(columns["time_s"]).all():
        faults.append("is damaged: a time is missing")
    if faults:
        raise InputError(str(path), faults)


def _new_columns(columns: parquet.Columns, record: Record) -> parquet.Columns:
    """What version 0.1 stored of a recording: parameters as contact, and segments as repeats."""
    contact, repeat = columns["contact"], columns["repeat"]
    if record.kind == "run":
        return {"parameters": np.full_like(contact, ""), "segment": np.zeros_like(repeat)}
    new = {"parameters": contact, "segment": repeat, "repeat": np.zeros_like(repeat)}
    return new if record.kind == "fit" else {**new, "contact": np.full_like(contact, "")}


def _from_columns(source: str, contact: str, columns: Mapping[str, Array]) -> Trajectory:
    signals: dict[str, list[Array]] = {}
    for name, values in columns.items():
        if name == "time_s" or np.isnan(values).all():
            continue
        base, dot, component = name.rpartition(".")
        is_part = dot and (component in ("w", "x", "y", "z") or component.isdigit())
        signals.setdefault(base if is_part else name, []).append(values)
    stacked = {
        name: np.column_stack(parts) if len(parts) > 1 else parts[0]
        for name, parts in signals.items()
    }
    return Trajectory(source, columns["time_s"], stacked, contact=contact)
