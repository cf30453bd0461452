"""What range sensors of many zones told, on disk: one row for each zone of each frame.

Zones are counted from 0, along rows from the left, rows from the top. An empty cell is a distance
that there is not; the status says why.
"""

from __future__ import annotations

import csv
import hashlib
import io
import itertools
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.hardware.sensors.drawn_zones import ZoneReading
from simcompare.hardware.sensors.multizone import Frames
from simcompare.model.parquet import Table
from simcompare.results.records.run import Record
from simcompare.results.run import Run, StoredReading

ZONES = "zones.csv"
_INDEX = ("source", "contact", "signal")
_WHOLE = ("zone", "status", "targets")
_COLUMNS = ("time_s", "zone", "ideal_m", "range_m", "status", "targets", "sigma_m")


def save(run: Run, folder: Path) -> dict[str, Table]:
    """Writes what the range sensors of a run told; returns what the record says of the file.

    Raises:
        OSError: it cannot be written.
    """
    text, rows = io.StringIO(), 0
    writer = csv.writer(text)
    writer.writerow((*_INDEX, *_COLUMNS))
    for one in run.stored_readings:
        if isinstance(one.reading, ZoneReading):
            columns = one.reading.columns()
            cells = zip(*(_cells(columns[name]) for name in _COLUMNS), strict=True)
            writer.writerows((one.source, one.contact, one.signal, *row) for row in cells)
            rows += len(columns["time_s"])
    if not rows:
        return {}
    content = text.getvalue().encode()
    (folder / ZONES).write_bytes(content)
    return {ZONES: Table(hashlib.sha256(content).hexdigest(), rows)}


def load(record: Record, folder: Path, again: str) -> tuple[StoredReading, ...]:
    """What the range sensors of a run told; nothing where there are none.

    Args:
        record: of the run.
        folder: where it is stored.
        again: what makes it anew.

    Raises:
        InputError: the file is damaged, or another one.
    """
    if ZONES not in record.tables:
        return ()
    path = folder / ZONES
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
    if hashlib.sha256(content).hexdigest() != record.tables[ZONES].sha256:
        fault = f"is not what was written: it is cut off, damaged or changed; {again}"
        raise InputError(str(path), [fault])
    _, *rows = csv.reader(io.StringIO(content.decode()))
    groups = itertools.groupby(rows, lambda row: tuple(row[: len(_INDEX)]))
    return tuple(
        StoredReading(source, contact, signal, _reading([row[len(_INDEX) :] for row in own]))
        for (source, contact, signal), own in groups
    )


def _cells(values: NDArray[Any]) -> list[object]:
    return ["" if value != value else value for value in values.tolist()]


def _reading(rows: list[list[str]]) -> ZoneReading:
    table = {
        name: np.array([float(cell or "nan") for cell in cells])
        for name, cells in zip(_COLUMNS, zip(*rows, strict=True), strict=True)
    }
    zones = 1 + int(table["zone"].max())
    told = {name: values.reshape(-1, zones) for name, values in table.items()}
    whole = {name: told[name].astype(int) for name in _WHOLE}
    frames = Frames(told["range_m"], whole["status"], whole["targets"], told["sigma_m"])
    return ZoneReading(told["time_s"][:, 0].copy(), told["ideal_m"], frames)
