"""A table of mean readings, as a class writes it down: one row for each pose or known value.

::

    pose,ax (g),ay,az          pose,gx (deg/s),gy,gz       known (hPa),u (hPa),reading (hPa),noise
    +x,1.01,0.02,-0.03         +x 90,91.2,0.4,-0.1         950,0.05,951.2,0.02
    -x,-0.98,0.01,0.02         rest,0.8,-0.2,0.1           1000,0.05,1001.1,0.02

The unit of a column holds for those to its right that have none; without any, values are in SI. A
column ``u`` (``noise`` of pressures) holds the standard uncertainty of a mean reading.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.sensors import sheet_units
from simcompare.hardware.sensors.calibrated import Readings
from simcompare.model import user_file
from simcompare.model.trajectory import Array
from simcompare.statistics.distributions import Distribution, fixed, normal

#: of such a table, and of its first line in characters
_MAX_MB, _LONGEST = 10.0, 10_000
_HEAD = re.compile(r"^\s*(?P<name>[^\s(\[]+)\s*[(\[]?(?P<unit>[^)\]]*)[)\]]?\s*$")
_RATE = re.compile(r"^\s*(?P<sign>[+-])(?P<axis>[xyz])\s+(?P<rate>[\d.]+)\s*$", re.I)
#: size of specific force at rest that can be none else [m/s²]
_AT_REST = (5.0, 15.0)
FORMS = "pose,ax,ay,az or pose,gx,gy,gz or known,u,reading"


@dataclass(frozen=True, eq=False)
class Table:
    """What a table holds, in SI.

    Attributes:
        kind: "accelerometer", "rate-table" or "two-point".
        readings: the means.
        rates: of a rate table (p, 3) [rad/s].
        known: of a pressure sensor.
    """

    kind: str
    readings: Readings
    rates: Array | None = None
    known: tuple[Distribution, ...] = ()


def is_table(path: Path) -> bool:
    """Whether a file is such a table, by its first line."""
    if path.suffix.lower() not in (".csv", ".txt"):
        return False
    user_file.check_is_stored(path)
    try:
        with path.open(encoding="utf-8-sig", errors="replace") as file:
            first = _HEAD.match(re.split("[,;]", file.readline(_LONGEST))[0])
    except OSError:
        return False
    return first is not None and first["name"].lower() in ("pose", "known")


def read(path: Path) -> Table:
    """Reads a table of mean readings.

    Raises:
        InputError: every fault of it, with its row and column.
    """
    rows = _rows(path)
    columns = _columns(path, rows[0])
    names = list(columns)
    if names[:1] == ["known"] and "reading" in names:
        return _pressures(path, columns, rows[1:])
    for kind, letter, unit in (("accelerometer", "a", "m/s**2"), ("rate-table", "g", "rad/s")):
        wanted = [f"{letter}{axis}" for axis in "xyz"]
        if set(wanted) <= set(names):
            return _poses(path, kind, wanted, unit, columns, rows[1:])
    raise InputError(str(path), [f"has the columns {', '.join(names)}; expected {FORMS}"])


def _rows(path: Path) -> list[list[str]]:
    """Cells of every row; with semicolons between them a comma is a decimal point."""
    text = user_file.content(path, _MAX_MB, "a table of mean readings").decode(
        "utf-8-sig", errors="replace"
    )
    mark = ";" if ";" in text.partition("\n")[0] else ","
    rows = [
        row for row in csv.reader(text.splitlines(), delimiter=mark) if any(map(str.strip, row))
    ]
    return rows if mark == "," else [[cell.replace(",", ".") for cell in row] for row in rows]


def _columns(path: Path, head: Sequence[str]) -> dict[str, str]:
    """Name -> unit as it is written; a column without one has that of the column to its left."""
    found, unit = {}, ""
    for cell in head:
        match = _HEAD.match(cell)
        if match is None:
            raise InputError(str(path), [f"line 1: {cell!r} is no head of a column"])
        unit = match["unit"].strip() or unit
        name = match["name"].lower()
        if name in found:
            raise InputError(str(path), [f"line 1: {name} stands there twice"])
        found[name] = unit
    return found


def _poses(
    path: Path, kind: str, wanted: list[str], unit: str, columns: Mapping[str, str],
    rows: Sequence[Sequence[str]],
) -> Table:  # fmt: skip
    names = tuple(row[0].strip() for row in rows)
    numbers = _numbers(path, columns, rows, [*wanted, *(["u"] if "u" in columns else [])])
    factor = {name: _factor(path, columns[name], unit) for name in numbers}
    means = np.column_stack([numbers[name] * factor[name] for name in wanted])
    u = np.repeat((numbers["u"] * factor["u"])[:, None], 3, axis=1) if "u" in numbers else None
    told = Readings(names, means, u, "the table" if u is not None else "what the fit leaves")
    if kind == "accelerometer":
        _check_size(path, means)
        return Table(kind, told)
    return Table(kind, told, rates=_rates(path, names, factor[wanted[0]]))


def _pressures(path: Path, columns: Mapping[str, str], rows: Sequence[Sequence[str]]) -> Table:
    wanted = [name for name in ("known", "u", "reading", "noise") if name in columns]
    numbers = _numbers(path, columns, rows, wanted)
    si = {name: numbers[name] * _factor(path, columns[name], "Pa") for name in wanted}
    u = si.get("u", np.zeros(len(rows)))
    known = tuple(
        normal(float(p), float(s)) if s else fixed(float(p))
        for p, s in zip(si["known"], u, strict=True)
    )
    noise = si["noise"][:, None] if "noise" in si else None
    names = tuple(f"{p:g} {columns['known'] or 'Pa'}" for p in numbers["known"])
    told = "the table" if noise is not None else "what the fit leaves"
    return Table("two-point", Readings(names, si["reading"][:, None], noise, told), known=known)


def _numbers(
    path: Path, columns: Mapping[str, str], rows: Sequence[Sequence[str]], wanted: Sequence[str]
) -> dict[str, Array]:
    place = {name: number for number, name in enumerate(columns)}
    found: dict[str, list[float]] = {name: [] for name in wanted}
    faults = []
    for line, row in enumerate(rows, start=2):
        for name in wanted:
            cell = row[place[name]].strip() if place[name] < len(row) else ""
            value, fault = _number(cell, name)
            found[name].append(value)
            faults += [f"line {line}, column {name}: {fault}"] if fault else []
    if not rows:
        faults.append("has no rows below its head")
    if faults:
        raise InputError(str(path), faults)
    return {name: np.array(values) for name, values in found.items()}


def _number(cell: str, name: str) -> tuple[float, str]:
    """A cell as a number, and what is wrong with it; empty where nothing is."""
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        return math.nan, f"{cell!r} is no number"
    if name in ("u", "noise") and value <= 0:
        return value, f"{cell} is no uncertainty; expected a number above 0"
    return value, ""


def _factor(path: Path, written: str, unit: str) -> float:
    if not written:
        return 1.0
    try:
        return sheet_units.amount(f"1 {written}", unit)
    except ValueError as error:
        raise InputError(str(path), [f"line 1: {error}"]) from None


def _check_size(path: Path, means: Array) -> None:
    size = float(np.median(np.linalg.norm(means, axis=1)))
    if not _AT_REST[0] < size < _AT_REST[1]:
        cure = "write the unit in the head, such as ax (g) or ax (mg)"
        raise InputError(str(path), [f"readings are of size {size:.4g} m/s² at rest; {cure}"])


def _rates(path: Path, names: Sequence[str], factor: float) -> Array:
    rates, faults = np.zeros((len(names), 3)), []
    for row, name in enumerate(names):
        match = _RATE.match(name)
        if match is not None:
            value = float(match["sign"] + match["rate"]) * factor
            rates[row, "xyz".index(match["axis"].lower())] = value
        elif name.lower() != "rest":
            fault = f"{name!r} is no pose; expected rest, or a turn such as +x 90"
            faults.append(f"line {row + 2}: {fault}")
    if faults:
        raise InputError(str(path), faults)
    return rates
