"""Tables of measured bounces: CSV with one row per bounce and a head of ``# key: value`` lines.

    # title: Table-tennis ball on a stone plate
    # citation: A. Author, Journal 1 (2020) 2
    # preset: table_tennis
    # drop_height: 31.5 cm
    bounce,rebound_height_cm,u_rebound_height_cm
    1,24.4,0.2

A column is a measured quantity of the scenario with its unit in its name or in brackets
(``rebound height [cm]``). Beside it stands its standard uncertainty ``u_…``, or the two limits
``…_low`` and ``…_high`` within which the value is certain; limits mean a rectangular distribution,
u = half-width/√3 (JCGM 100:2008, 4.3.7).
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from simcompare import units
from simcompare.errors import InputError, UnknownName, unknown_or_missing
from simcompare.hardware.logs.text.sniff import split
from simcompare.hardware.recordings import published

_MAX_HEADING = 100

#: head lines that describe the table rather than set a parameter
HEAD_KEYS = ("title", "citation", "url", "note", "preset", "scenario", "seen")


@dataclass(frozen=True)
class Quantity:
    """One measured number.

    Attributes:
        name: quantity as the scenario's measures name it ("rebound_height").
        bounce: number of the bounce, first is 1.
        value: measured value, SI.
        u: its standard uncertainty, ``None`` where none is stated.
        low: smallest value that is certain, where limits are given.
        high: largest value that is certain.
    """

    name: str
    bounce: int
    value: float
    u: float | None
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class BounceTable:
    """Measured bounces with their source.

    Attributes:
        path: the file.
        sha256: of the file.
        head: title, citation and so on.
        parameters: scenario parameters that the head sets, as text with units.
        quantities: the measured numbers.
    """

    path: Path
    sha256: str
    head: Mapping[str, str]
    parameters: Mapping[str, str]
    quantities: tuple[Quantity, ...]

    @property
    def preset(self) -> str | None:
        """Preset of the scenario that the table was measured with."""
        return self.head.get("preset")


def find(name: str) -> Path:
    """A table given by file or by the name of a published fact.

    Raises:
        UnknownName: neither exists.
    """
    path = Path(name)
    try:
        if path.is_file():
            return path
    except OSError:  # a name too long for the file system
        pass
    known = published.tables()
    if name in known:
        return known[name]
    raise unknown_or_missing("file or published table", name, known)


def read(path: Path, known: Mapping[str, str]) -> BounceTable:
    """Reads a table.

    Args:
        path: the CSV file.
        known: measured quantities of the scenario and their SI units.

    Raises:
        InputError: every fault of the file, each with its line.
    """
    try:
        raw = path.read_bytes()
        text = raw.decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(path), [f"cannot be read as UTF-8 text: {error}"]) from None
    head, parameters, body = _split(text)
    faults: list[str] = []
    quantities = _quantities(body, known, faults)
    places = [(quantity.name, quantity.bounce) for quantity in quantities]
    for name, bounce in dict.fromkeys(places):
        if places.count((name, bounce)) > 1:
            faults.append(f"{name} of bounce {bounce} stands more than once")
    if not quantities and not faults:
        faults.append(
            "holds no measured values; expected a header row and at least one row below it"
        )
    if faults:
        raise InputError(str(path), faults)
    digest = hashlib.sha256(raw).hexdigest()
    return BounceTable(path, digest, head, parameters, tuple(quantities))


def _split(text: str) -> tuple[dict[str, str], dict[str, str], list[tuple[int, str]]]:
    """Head, parameters, and the remaining lines with their numbers."""
    head: dict[str, str] = {}
    parameters: dict[str, str] = {}
    body = []
    for number, line in enumerate(text.splitlines(), start=1):
        if line.startswith("#"):
            key, colon, value = line.lstrip("# ").partition(":")
            key, value = key.strip(), value.strip()
            # "Author: …" and "https://…" are remarks; names of parameters begin with a small letter
            if colon and re.fullmatch(r"[a-z]\w*", key) and not value.startswith("//"):
                (head if key in HEAD_KEYS else parameters)[key] = value
        elif line.strip():
            body.append((number, line))
    return head, parameters, body


@dataclass(frozen=True)
class _Column:
    name: str
    role: str  # "value", "u", "low", "high" or "bounce"
    factor: float


def _quantities(
    body: list[tuple[int, str]], known: Mapping[str, str], faults: list[str]
) -> list[Quantity]:
    if not body:
        return []
    number, header = body[0]
    separator = max(",;\t", key=header.count)
    columns = _columns(number, split(header, separator), known, faults)
    if faults:
        return []
    quantities: list[Quantity] = []
    for counted, (row_number, line) in enumerate(body[1:], start=1):
        cells = split(line, separator)
        if len(cells) == len(columns):
            comma = separator != ","  # then a comma within a number can only be the decimal one
            quantities += _row(row_number, cells, columns, faults, counted, decimal_comma=comma)
        else:
            faults.append(
                f"line {row_number}: {len(cells)} cells but the header has {len(columns)} columns"
            )
    return quantities


def _columns(
    number: int, headings: list[str], known: Mapping[str, str], faults: list[str]
) -> list[_Column]:
    """What every heading says; adds a fault for what does not belong together."""
    columns = []
    for text in headings:
        try:
            columns.append(_column(text.strip()[:_MAX_HEADING], known))
        except InputError as error:
            faults.extend(f"line {number}, {error.where}: {fault}" for fault in error.faults)
    if faults:
        return columns
    roles = [(column.name, column.role) for column in columns]
    # limits alone are a measurement too
    measured = [name for name, role in roles if role in ("value", "low", "high")]
    if not measured:
        faults.append(f"line {number}: no measured quantity; known: {', '.join(known)}")
    for name, role in dict.fromkeys(roles):
        if roles.count((name, role)) > 1:
            faults.append(f"line {number}: {name} ({role}) stands twice")
        if role in ("u", "low", "high") and measured and name not in measured:
            faults.append(f"line {number}: {role} of {name} is given, but {name} itself is not")
        if (name, {"low": "high", "high": "low"}.get(role, role)) not in roles:
            faults.append(f"line {number}: only one limit of {name} is given; give both")
    return columns


def _column(text: str, known: Mapping[str, str]) -> _Column:
    """What a column's heading says: quantity, role and factor to SI."""
    match = re.fullmatch(r"(.*?)\s*[\[(](.*)[\])]", text)
    name, unit = (match[1], match[2]) if match else (text, "")
    name = re.sub(r"[\s-]+", "_", name.strip())
    if name == "bounce":
        return _Column("bounce", "bounce", 1.0)
    role = "value"
    if name.startswith("u_"):
        name, role = name[2:], "u"
    for ending in ("low", "high"):
        if name.endswith(f"_{ending}"):
            name, role = name.removesuffix(f"_{ending}"), ending
    for quantity, si_unit in known.items():
        if name == quantity or name.startswith(f"{quantity}_"):
            stated = unit or name.removeprefix(quantity).removeprefix("_")
            stated = units.UNITS_BY_SUFFIX.get(f"_{stated}", stated)  # "m_s" as in our own names
            for ending in ("low", "high"):  # "rebound_height_low_cm"
                if stated.startswith(f"{ending}_"):
                    stated, role = stated.removeprefix(f"{ending}_"), ending
            if not stated and si_unit != "1":
                raise InputError(f"column {text!r}", [f"has no unit; write {quantity} [{si_unit}]"])
            factor = units.conversion_factor(stated, si_unit, f"column {text!r}") if stated else 1.0
            return _Column(quantity, role, factor)
    raise InputError(f"column {text!r}", [str(UnknownName("measured quantity", name, known))])


def _row(
    number: int,
    cells: list[str],
    columns: list[_Column],
    faults: list[str],
    next_bounce: int,
    *,
    decimal_comma: bool,
) -> list[Quantity]:
    values: dict[tuple[str, str], float] = {}
    for cell, column in zip(cells, columns, strict=True):
        if not cell.strip():
            continue
        try:
            value = float(cell.replace(",", ".") if decimal_comma else cell) * column.factor
        except ValueError:
            hint = "; write decimals with a point" if "," in cell else ""
            faults.append(f"line {number}: {cell!r} is not a number{hint}")
            continue
        if not math.isfinite(value):
            faults.append(f"line {number}: {cell!r} is not finite")
        elif column.role == "u" and value <= 0:
            faults.append(f"line {number}: an uncertainty must be above 0, found {cell}")
        else:
            values[column.name, column.role] = value
    bounce = values.get(("bounce", "bounce"), float(next_bounce))
    if bounce < 1 or bounce != int(bounce):
        faults.append(f"line {number}: a bounce is numbered 1, 2, 3, …, found {bounce:g}")
    quantities = []
    for name in dict.fromkeys(column.name for column in columns if column.role != "bounce"):
        stated = {role: values.get((name, role)) for role in ("value", "u", "low", "high")}
        low, high = stated["low"], stated["high"]
        if stated["value"] is None and low is not None and high is not None:
            stated["value"] = (low + high) / 2  # limits alone: the centre stands for them
        if stated["value"] is not None:
            quantities.append(_quantity(number, name, int(bounce), list(stated.values()), faults))
    return quantities


def _quantity(
    number: int, name: str, bounce: int, limits: list[float | None], faults: list[str]
) -> Quantity:
    value, u, low, high = limits
    assert value is not None
    if low is not None and high is not None:
        if not low <= value <= high or low == high:
            faults.append(f"line {number}: {name} = {value:g} is not within {low:g} … {high:g}")
        elif u is None:
            u = (high - low) / 2 / math.sqrt(3)
    return Quantity(name, bounce, value, u, low, high)
