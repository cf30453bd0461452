"""Text logs of libRSF, the robust sensor fusion library of TU Chemnitz.

Each line begins with the kind of a measurement and its time; its columns follow from the kind:

    range2 0.1279 2.9552 0.01 -0.02 -0.01 105 0
    odom2diff 0.1279 0.0012 0.0013 0 0.0785 0.0001 0.0001 0.0001

Each kind becomes a stream, ranges one of each beacon. Sensors are in ``<name>_Input.txt``; where
the truth lies beside it, in ``<name>_GT.txt``, it is read as well. The names of the columns are
those that the data sets' own documentation gives them, whether they are right or not. Covariances
become standard uncertainties.
"""

from __future__ import annotations

import math
from collections.abc import Mapping as MappingOf
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream, Spool
from simcompare.model.recording import INFO, Clock, Repair

TITLE = "measurements of libRSF, one a line"

#: kind -> columns after the time, and their units
KINDS: MappingOf[str, tuple[tuple[str, str], ...]] = {
    "range2": (
        ("range", "m"), ("range_covariance", "m^2"), ("beacon_x", "m"), ("beacon_y", "m"),
        ("beacon", "1"), ("signal_to_noise", "1"),
    ),
    "odom2diff": (
        ("velocity_right", "m/s"), ("velocity_left", "m/s"), ("velocity_side", "m/s"),
        ("wheel_distance", "m"), ("velocity_right_covariance", "m^2/s^2"),
        ("velocity_left_covariance", "m^2/s^2"), ("velocity_side_covariance", "m^2/s^2"),
    ),
    "point2": (
        ("x", "m"), ("y", "m"), ("x_covariance", "m^2"), ("xy_covariance", "m^2"),
        ("yx_covariance", "m^2"), ("y_covariance", "m^2"),
    ),
}  # fmt: skip
#: the column that tells streams of one kind apart
APART = {"range2": "beacon"}
#: ends the name of a column that becomes the uncertainty of another
COVARIANCE = "_covariance"
SENSORS, TRUTH = "_Input.txt", "_GT.txt"
_MAX_SHOWN = 20


def recognises(head: Head) -> int:
    """By the first lines, each of a known kind with its number of columns."""
    lines = (
        [] if head.members else [line for line in _source.head_lines(head.start) if line.strip()]
    )
    cells = [line.split() for line in lines[:5]]
    known = [row[0] in KINDS and len(row) == 2 + len(KINDS[row[0]]) for row in cells]
    return 95 if known and all(known) else 0


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads the sensors, and the truth beside them.

    Raises:
        InputError: lines of no known kind, with another number of columns, or with no numbers.
    """
    log = RawLog([])
    _read_one(path, log)
    beside = path.with_name(path.name.removesuffix(SENSORS) + TRUTH)
    if path.name.endswith(SENSORS) and beside.is_file():
        _read_one(beside, log)
        text = f"the truth was read from {beside.name}, which lies beside it"
        log.repairs.append(Repair("second_file", INFO, text))
    return log


def _read_one(path: Path, log: RawLog) -> None:
    source = _source.source_of(path)
    log.repairs += source.repairs
    rows: dict[str, Spool] = {}
    numbers: dict[str, list[int]] = {}
    faults: list[str] = []
    count, cut = 0, ""
    for block in _source.blocks(source):
        for number, line in enumerate(block.lines, start=block.line):
            fault = _take(line.split(), number, rows, numbers)
            if not fault:
                continue
            if not block.ended and number == block.line + len(block.lines) - 1:
                cut = f"the last line, {number}, is cut off: {line[-20:]!r}"
                continue
            count += 1
            if count <= _MAX_SHOWN:
                faults.append(f"line {number}: {fault}")
    if count > _MAX_SHOWN:
        faults.append(f"and {count - _MAX_SHOWN} more lines like these")
    if faults or not rows:
        raise InputError(str(path), faults or ["holds no measurement of a known kind"])
    for name, spool in rows.items():
        log.streams.append(_stream(name, spool, numbers[name], cut))


def _take(
    cells: Sequence[str], number: int, rows: dict[str, Spool], numbers: dict[str, list[int]]
) -> str:
    """Adds one line to its stream; what is wrong with it, in words."""
    if not cells:
        return ""
    kind = cells[0]
    if kind not in KINDS:
        return f"{kind[:40]!r} is no known kind; expected {', '.join(KINDS)}"
    columns = KINDS[kind]
    if len(cells) != 2 + len(columns):
        return f"{kind} has {len(cells)} cells; expected {2 + len(columns)}"
    try:
        values = [float(cell) for cell in cells[1:]]
    except ValueError as error:
        return f"{error}; expected a number"
    if not math.isfinite(values[0]):
        return f"its time is {cells[1]}; expected a number"
    name = kind
    if kind in APART:
        place = [column for column, _ in columns].index(APART[kind])
        name = f"{kind}_{cells[2 + place]}"
    rows.setdefault(name, Spool(1 + len(columns))).append(np.array([values]))
    numbers.setdefault(name, []).append(number)
    return ""


def _stream(name: str, spool: Spool, numbers: list[int], cut: str) -> RawStream:
    named = (("time", "s"), *KINDS[name.partition("_")[0]])
    columns = [
        RawColumn(column, values, unit)
        for (column, unit), values in zip(named, spool.columns(), strict=True)
    ]
    by_name = {column.name: column for column in columns}
    for column in columns:
        spread = by_name.get(f"{column.name}{COVARIANCE}")
        # zeros stand for a covariance that is not known
        if spread is not None and np.all(spread.values > 0):
            column.u = np.sqrt(spread.values)
    kept = [column for column in columns if COVARIANCE not in column.name]
    return RawStream(
        name, kept, "time", clock=Clock("column time"), rows=np.array(numbers, dtype=np.int64),
        truncated=cut,
    )  # fmt: skip
