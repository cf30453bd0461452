"""Tables of measured bounces: CSV with one row per bounce and a head of ``# key: value`` lines.

    # title: Table-tennis ball on a stone plate
    # citation: A. Author, Journal 1 (2020) 2
    # preset: table_tennis
    # drop_height: 31.5 cm
    bounce,rebound_height_cm,u_rebound_height_cm
    1,24.4,0.2

A column is a measured quantity of the scenario with its unit in its name or in brackets
(``rebound height [cm]``). Telephones call it otherwise (``"Time interval (s)"``), or number the
columns (``Interval 1 (s),Interval 2 (s)``) and give one row. Beside it stands its standard
uncertainty ``u_…``, or the two limits ``…_low`` and ``…_high`` within which the value is certain;
limits mean a rectangular distribution, u = half-width/√3 (JCGM 100:2008, 4.3.7).
"""

from __future__ import annotations

import codecs
import hashlib
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from simcompare.errors import InputError, unknown_or_missing
from simcompare.hardware.logs.text.cell import split
from simcompare.hardware.recordings import bounce_headings, published
from simcompare.hardware.recordings.bounce_headings import HEIGHT, Column
from simcompare.model import user_file

#: size of such a table [MB]
_MAX_MB = 10.0
#: head lines that describe the table rather than set a parameter
HEAD_KEYS = ("title", "citation", "url", "note", "preset", "scenario", "seen")
#: finest relative uncertainty that is believed; float64 itself is not much finer
_FINEST = 1e-12


@dataclass(frozen=True)
class Quantity:
    """One measured number.

    Attributes:
        name: quantity as the scenario's measures name it ("rebound_height").
        bounce: number of the bounce, first is 1; a height of number 0 is that of the drop.
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
    raw = user_file.content(path, _MAX_MB, "a table of bounces")
    try:
        text = decoded(raw)
    except UnicodeDecodeError as error:
        raise InputError(
            str(path), [f"cannot be read as UTF-8 text ({error}); save it as CSV UTF-8"]
        ) from None
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


def decoded(raw: bytes, errors: str = "strict") -> str:
    """The text of a table: UTF-8, or UTF-16 where it begins with the mark of that."""
    wide = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    return raw.decode("utf-16" if wide else "utf-8-sig", errors=errors)


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


def _quantities(
    body: list[tuple[int, str]], known: Mapping[str, str], faults: list[str]
) -> list[Quantity]:
    if not body:
        return []
    number, header = body[0]
    separator = max(",;\t", key=header.count)
    columns = bounce_headings.columns(number, split(header, separator), known, faults)
    if faults:
        return []
    quantities: list[Quantity] = []
    before = 0
    for counted, (row_number, line) in enumerate(body[1:], start=1):
        cells = split(line, separator)
        if len(cells) == len(columns):
            comma = separator != ","  # then a comma within a number can only be the decimal one
            row = _row(row_number, cells, columns, faults, counted, decimal_comma=comma)
            quantities += row
            if row and row[0].bounce < before:
                faults.append(f"line {row_number}: bounce {row[0].bounce} stands after bounce"
                              f" {before}; number the rows upwards")  # fmt: skip
            before = row[0].bounce if row else before
        else:
            faults.append(
                f"line {row_number}: {len(cells)} cells but the header has {len(columns)} columns"
            )
    return quantities


def _row(
    number: int,
    cells: list[str],
    columns: list[Column],
    faults: list[str],
    next_bounce: int,
    *,
    decimal_comma: bool,
) -> list[Quantity]:
    values: dict[tuple[str, int | None, str], float] = {}
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
            values[column.name, column.bounce, column.role] = value
    named = values.get(("bounce", None, "bounce"), float(next_bounce))
    quantities = []
    places = [(column.name, column.bounce) for column in columns if column.role != "bounce"]
    for name, own in dict.fromkeys(places):
        stated = {role: values.get((name, own, role)) for role in ("value", "u", "low", "high")}
        low, high = stated["low"], stated["high"]
        if stated["value"] is None and low is not None and high is not None:
            stated["value"] = (low + high) / 2  # limits alone: the centre stands for them
        bounce = named if own is None else float(own)
        if stated["value"] is None:
            continue
        if bounce != int(bounce) or bounce < (0 if name == HEIGHT else 1):
            faults.append(f"line {number}: a bounce is numbered 1, 2, 3, … (0 is the drop, of which"
                          f" there is a rebound_height alone), found {bounce:g}")  # fmt: skip
        else:
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
    if u is not None and u < _FINEST * abs(value):
        faults.append(f"line {number}: {name} = {value:g} with an uncertainty of {u:g}: nothing is"
                      " measured that finely; state the standard uncertainty, or leave out its"
                      " column")  # fmt: skip
    return Quantity(name, bounce, value, u, low, high)
