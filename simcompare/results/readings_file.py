"""What sensors read, on disk: one table, a row for each sample of each signal of each source."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.sensors.error_model import Reading
from simcompare.model import parquet
from simcompare.model.parquet import Table
from simcompare.model.trajectory import Array
from simcompare.results.records.run import Record
from simcompare.results.run import Run, StoredReading

READINGS = "readings.parquet"
#: columns that say whose sample a row is
_INDEX = ("source", "contact", "signal")
_AXES = "xyz"
_KINDS = ("ideal", "measured", "saturated")


def save(run: Run, folder: Path) -> dict[str, Table]:
    """Writes what the sensors of a run read; returns what the record says of the file.

    Args:
        run: the run.
        folder: where to.

    Raises:
        OSError: it cannot be written.
    """
    found = [(one, one.reading) for one in run.stored_readings if isinstance(one.reading, Reading)]
    return {READINGS: _write(folder / READINGS, found)} if found else {}


def load(record: Record, folder: Path, again: str) -> tuple[StoredReading, ...]:
    """What the sensors of a run read; nothing where there is no file.

    Args:
        record: of the run.
        folder: where it is stored.
        again: what makes it anew.

    Raises:
        InputError: the file is damaged, or another one.
    """
    path = folder / READINGS
    if READINGS not in record.tables and not path.exists():
        return ()
    columns = parquet.read(path, record.tables.get(READINGS, Table()), again)
    _check(path, columns, again)
    keys = list(zip(*(columns[name].tolist() for name in _INDEX), strict=True))
    starts = [i for i, key in enumerate(keys) if i == 0 or key != keys[i - 1]]
    return tuple(
        _stored(keys[start], {name: values[start:end] for name, values in columns.items()})
        for start, end in zip(starts, [*starts[1:], len(keys)], strict=True)
    )


def _check(path: Path, columns: parquet.Columns, again: str) -> None:
    """Refuses a table that is none of readings.

    Raises:
        InputError: which columns are missing, or hold no numbers.
    """
    signals = [f"{kind}.{axis}" for kind in _KINDS for axis in _AXES]
    faults = [f"has no column {name}; {again}" for name in (*_INDEX, "time_s", *signals)
              if name not in columns]  # fmt: skip
    faults += [f"its column {name} holds no numbers; {again}" for name in ("time_s", *signals)
               if name in columns and columns[name].dtype != np.float64]  # fmt: skip
    if faults:
        raise InputError(str(path), faults)


def _write(path: Path, readings: Sequence[tuple[StoredReading, Reading]]) -> Table:
    blocks = [_columns(reading) for _, reading in readings]
    lengths = [len(reading.time_s) for _, reading in readings]
    table = {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}
    numbers = np.repeat(np.arange(len(readings)), lengths)
    labels = [(i, *(getattr(one, name) for name in _INDEX)) for i, (one, _) in enumerate(readings)]
    index = ", ".join(_INDEX)
    with parquet.connect() as connection:
        _, *columns = parquet.register(connection, "samples", {"entry": numbers, **table})
        row = f"({', '.join('?' * (1 + len(_INDEX)))})"
        connection.execute(
            f"create table labels as from (values {', '.join([row] * len(labels))})"
            f" t(entry, {index})",
            [value for label in labels for value in label],
        )
        query = (
            f"select {index}, {', '.join(columns)} from samples join labels"
            " on samples.c0 = labels.entry order by entry, time_s"
        )
        return parquet.write(connection, query, path)


def _stored(key: tuple[str, ...], columns: dict[str, Array]) -> StoredReading:
    source, contact, signal = key
    return StoredReading(source, contact, signal, _reading(columns))


def _columns(reading: Reading) -> dict[str, Array]:
    """Time, and ideal, measured and saturated of x, y and z; of one axis x alone."""
    count = len(reading.time_s)
    table = {"time_s": reading.time_s}
    for kind in _KINDS:
        values = np.asarray(getattr(reading, kind), dtype=float).reshape(count, -1)
        for i, axis in enumerate(_AXES):
            there = i < values.shape[1]
            table[f"{kind}.{axis}"] = values[:, i].copy() if there else np.full(count, np.nan)
    return table


def _reading(columns: dict[str, Array]) -> Reading:
    one = bool(np.isnan(columns["ideal.y"]).all())
    ideal, measured, saturated = (
        columns[f"{kind}.x"] if one else np.column_stack([columns[f"{kind}.{a}"] for a in _AXES])
        for kind in _KINDS
    )
    return Reading(columns["time_s"], ideal, measured, saturated > 0)
