"""What stands in the cells of a text table: numbers, flags, units, headings."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Sequence

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.mapping import Mapping
from simcompare.model.trajectory import Array

#: cells that say that nothing was measured
MISSING = (
    "", "nan", "NaN", "NAN", "Nan", "-nan", "-NaN", "-nan(ind)", "NA", "N/A", "n/a", "#N/A", "null",
    "NULL", "None", "1.#QNAN", "-1.#IND", "1.#IND",
)  # fmt: skip
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?", re.ASCII)
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d*)?", re.ASCII)
_TIME = re.compile(
    r"%?time|t|time ?stamps?|stamp|date ?/? ?time|date|zeit|temps|elapsed(?: time)?"
    r"|(?:milli|micro|nano)?sec(?:ond)?s?|time of day|unix ?time|epoch|clock",
    re.IGNORECASE,
)
#: characters of numbers that Python reads as logs mean them
_PLAIN = b"0123456789.eE+- \t\n"
_INFINITE = re.compile(r"([+-]?)(?:inf|infinity|1\.#inf|∞)", re.IGNORECASE)
_BRACKETS = re.compile(r"(.*?)\s*[(\[{<]\s*([^()\[\]{}<>]*?)\s*[)\]}>]")
_SLASH = re.compile(r"(.*?)\s+(?:/|in)\s+(\S+)")
#: units that stand at the end of names, beside those of SI
_SUFFIXES = {
    "deg": "deg", "deg_s": "deg/s", "dps": "deg/s", "rpm": "rpm", "rps": "turn/s", "um": "um",
    "mm": "mm", "cm": "cm", "km": "km", "mm_s": "mm/s", "mm_s2": "mm/s^2", "mV": "mV", "mA": "mA",
    "uA": "uA", "kPa": "kPa", "hPa": "hPa", "mbar": "mbar", "degC": "degC", "uT": "uT", "mT": "mT",
    "ms": "ms", "us": "us", "ns": "ns", "sec": "s", "Nm": "N*m", "mNm": "mN*m", "kHz": "kHz",
    "MHz": "MHz", "mW": "mW", "kW": "kW", "mN": "mN", "kN": "kN",
}  # fmt: skip
_SUFFIXED = re.compile(rf"(.+)_({'|'.join(sorted(_SUFFIXES, key=len, reverse=True))})")


def is_time(name: str) -> bool:
    """Whether a column holds the time, by its name: ``time_s`` as well as ``Time``."""
    bare = name.strip(" _").removesuffix("_s")
    return bool(_TIME.fullmatch(bare.replace("_", " ")))


def unit_of_time(name: str) -> str:
    """Unit of a column that is called by it ("seconds", ``time_s``), empty otherwise."""
    if name.strip().endswith("_s"):
        return "s"
    match = re.fullmatch(r"(milli|micro|nano)?sec(?:ond)?s?", name.strip().lower())
    return {None: "s", "milli": "ms", "micro": "us", "nano": "ns"}[match[1]] if match else ""


def several_times(names: Sequence[str]) -> str:
    """What to say where several columns may be the time."""
    quoted = " and ".join(repr(name) for name in names[:4])
    return (
        f"columns {quoted} may all be the time; say which in a mapping file (--map) with"
        f" time: {{column: {names[0]}, unit: s}}"
    )


def wanted_names(mapping: Mapping) -> set[str]:
    """Names of columns that a mapping uses, with and without their stream."""
    names = {name for channel in mapping.channels.values() for name in channel.columns}
    names |= {name.rpartition("/")[2] for name in names}
    return names | ({*mapping.time.columns} if mapping.time else set())


def number(text: str, decimal: str = ".", thousands: str = "") -> float | None:
    """A number as a log writes it, NaN for an empty cell, ``None`` for what is no number."""
    text = text.strip()
    if text in MISSING:
        return float("nan")
    if decimal == ",":
        if "." in text and thousands != ".":
            return None
        text = text.translate(str.maketrans(",.", ".,"))
    if thousands and _GROUPED.fullmatch(text):
        text = text.replace(",", "")
    if _NUMBER.fullmatch(text):
        return float(text.replace("d", "e").replace("D", "e"))
    infinite = _INFINITE.fullmatch(text)
    if infinite:
        return float(f"{infinite[1]}inf")
    return None


def numbers(cells: Sequence[str], decimal: str = ".", thousands: str = "") -> Array | None:
    """Many numbers as a log writes them; ``None`` where one is no number."""
    text = "\n".join(cells)
    if decimal == ",":  # a point, which is none of its decimals, must not become one
        text = text.replace(".", "x").replace(",", ".")
    if not text.encode().translate(None, _PLAIN):
        try:
            return np.fromiter(map(float, text.split("\n")), np.float64, len(cells))
        except ValueError:  # an empty cell, a date
            pass
    values = [number(cell, decimal, thousands) for cell in cells]
    return None if None in values else np.array(values, dtype=np.float64)


def flags(cells: Iterable[str]) -> Array | None:
    """Cells true and false as 1 and 0; ``None`` where one is neither and not empty."""
    words = [cell.strip() for cell in cells]
    words = ["" if word in MISSING else word.lower() for word in words]
    values = {"true": 1.0, "false": 0.0, "": math.nan}
    if not all(word in values for word in words):
        return None
    return np.array([values[word] for word in words])


def is_unit(text: str) -> bool:
    """Whether a text is a unit that the program knows; a bare number is an index, no unit."""
    if not text or text.isdigit() or len(text) > 20:
        return False
    try:
        units.si_of(text, "")
    except InputError:
        return False
    return True


def heading(text: str) -> tuple[str, str]:
    """Name and unit of a column: ``acc (m/s^2)``, ``acc [g]``, ``t / s``, ``C1 in V``, ``t_ms``."""
    text = " ".join(text.split())
    for pattern in (_BRACKETS, _SLASH):
        match = pattern.fullmatch(text)
        if match and match[1] and is_unit(match[2]):
            return match[1].strip(), match[2]
    match = _SUFFIXED.fullmatch(text)
    if match:
        return match[1], _SUFFIXES[match[2]]
    return text, ""


def headings(
    cells: Sequence[str], units_below: Sequence[str] = (), keep: Collection[str] = ()
) -> list[tuple[str, str]]:
    """Names and units of all columns.

    Args:
        cells: the header, cell by cell.
        units_below: units of a row below, empty where there is none.
        keep: names that a mapping uses; a heading that is one of them stays whole.
    """
    heads = []
    for i, cell in enumerate(cells):
        full = " ".join(cell.split())
        name, unit = heading(full)
        below = units_below[i].strip(" ()[]{}<>") if i < len(units_below) else ""
        if below:
            name, unit = full, below
        elif full in keep:
            name = full
        heads.append((name or f"column_{i + 1}", unit, full))
    names = [name for name, _, _ in heads]
    # two headings that differ in their unit alone stay whole
    return [(full if names.count(name) > 1 and full else name, unit) for name, unit, full in heads]


def about_of(lines: Sequence[str]) -> dict[str, str]:
    """What lines above a table say: ``key: value``, ``key = value`` or ``key,value``."""
    about: dict[str, str] = {}
    for line in lines:
        text = line.strip().lstrip("#%/!").strip().strip('"')
        match = re.match(r"([^:=,;\t]{1,60}?)\s*[:=,;\t]\s*(.+)", text)
        if match:
            about.setdefault(match[1].strip(' "'), match[2].strip(' ",;\t')[:400])
        elif text.strip(",;\t "):
            about.setdefault(f"remark {len(about) + 1}", text.strip(",;\t ")[:400])
    return about
