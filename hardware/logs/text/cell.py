"""What stands in the cells of a text table: numbers, flags, units, headings."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Collection, Iterable, Sequence

import numpy as np

from simcompare import units
from simcompare.hardware.logs.text import clocks, dates
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import told_apart
from simcompare.model.trajectory import Array
from simcompare.units import endings

#: cells that say that nothing was measured
MISSING = (
    "", "-", "--", "---", "?",
    "nan", "NaN", "NAN", "Nan", "-nan", "-NaN", "-nan(ind)", "NA", "N/A", "n/a", "#N/A", "null",
    "NULL", "None", "1.#QNAN", "-1.#IND", "1.#IND",
    "#VALUE!", "#DIV/0!", "#NUM!", "#REF!", "#NAME?", "#NULL!",  # as spreadsheets write them
)  # fmt: skip
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?", re.ASCII)
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d*)?", re.ASCII)
#: characters of numbers that Python reads as logs mean them
_PLAIN = b"0123456789.eE+- \t\n"
_INFINITE = re.compile(r"([+-]?)(?:inf|infinity|1\.#inf|∞)", re.IGNORECASE)
_BRACKETS = re.compile(r"(.*?)\s*[(\[{<]\s*(?:in )?((?:[^()\[\]{}<>]|\([^()]*\))*?)\s*[)\]}>]")
#: what says that there is no unit
_NO_UNIT = re.compile(r"(.*?)\s*(?:\[\s*([1–-]?)\s*\]|\(\s*([1–-]?)\s*\)|\{\s*(1?)\s*\})")
_SLASH = re.compile(r"(.*?)(?:\s+/\s+|\s+in\s+|,\s+)(\S+)")
_OVER = re.compile(r"([^/]*\w)/(\w+)")
#: quantity over unit, as German standards write it: t/s, v/(m/s)
_DIN = re.compile(
    r"([A-Za-zΑ-ω](?:\w?|_\w+)|alpha|beta|gamma|phi|theta|omega)/(\([^()]+\)|[^/()\s]+)"
)
#: the same with a word; one letter after it may be a part, as in phase/A
_WORD_OVER = re.compile(r"([A-Za-zΑ-ω][\w ]+)/([^/()\s\d]{2,}(?:/[^/()\s]+)?)")
#: a unit before the end of a name, where no word can be meant: acc (m/s²) x
_WITHIN = re.compile(r"(.*?)\s*[(\[]\s*([^()\[\]]*[/°²^][^()\[\]]*)\s*[)\]]\s*(.+)")
#: how sure the numbers are, behind their unit: Time (s) (± 0.01 s)
_UNCERTAIN = re.compile(r"(?<=[)\]])\s*[(\[]\s*(?:±|\+/?-)\s*[\d.][^()\[\]]*[)\]]$")
_ONE_LETTER = re.compile(r"(.*?)\s*[(\[{<]\s*(\w)\s*[)\]}>]")
_SLASHED = re.compile(r"(.+)_([A-Za-z°µμ]+/[A-Za-z0-9^²*]+)")
#: units that stand at the end of names, beside those of SI
_SUFFIXES = {
    "deg": "deg", "deg_s": "deg/s", "dps": "deg/s", "rpm": "rpm", "rps": "turn/s", "um": "um",
    "mm": "mm", "cm": "cm", "km": "km", "mm_s": "mm/s", "mm_s2": "mm/s^2", "mV": "mV", "mA": "mA",
    "uA": "uA", "kPa": "kPa", "hPa": "hPa", "mbar": "mbar", "degC": "degC", "uT": "uT", "mT": "mT",
    "ms": "ms", "us": "us", "ns": "ns", "sec": "s", "Nm": "N*m", "mNm": "mN*m", "kHz": "kHz",
    "MHz": "MHz", "mW": "mW", "kW": "kW", "mN": "mN", "kN": "kN",
    "g": "g", "mg": "mg", "mps": "m/s", "mps2": "m/s^2", "ms2": "m/s^2", "kmh": "km/h",
    "kph": "km/h", "mph": "mph", "radps": "rad/s", "degps": "deg/s",
    "%": "%", "pct": "%", "percent": "%", "degF": "degF",
}  # fmt: skip
_SUFFIXED = re.compile(rf"(.+(?<!_per))_({'|'.join(sorted(_SUFFIXES, key=len, reverse=True))})")


#: what remarks begin with
COMMENTS = ("#", "%", "//", "!", "=~=~")
_NMEA = re.compile(r"\$[A-Z]{2,3}[A-Z\d]{3},")
_LIST = re.compile(r"[\[(]\s*[-+.\deE,;\s]*[\])]")


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
    if dates.NEVER.fullmatch(text):
        return float("nan")
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


def split(line: str, separator: str) -> list[str]:
    """Cells of one line."""
    if separator == " ":
        return line.split()
    if '"' not in line and "\r" not in line:  # far faster, and the usual case
        return line.split(separator)
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        return [line]


def kind_of(cell: str) -> str:
    """What one cell holds."""
    text = cell.strip()
    if text in MISSING or dates.NEVER.fullmatch(text):
        return "empty"
    if any(number(text, d, t) is not None for d, t in ((".", ","), (",", "."))):
        return "number"
    if text.lower() in ("true", "false"):
        return "flag"
    if _LIST.fullmatch(text):
        return "list"
    return "date" if dates.looks_like_date(text) else "text"


def is_comment(line: str) -> bool:
    """Whether a line is a remark."""
    return line.lstrip().startswith(COMMENTS) or is_nmea(line)


def is_nmea(line: str) -> bool:
    """Whether a line is a sentence of a GPS among others."""
    return line.startswith("$") and bool(_NMEA.match(line))


def is_unit(text: str) -> bool:
    """Whether a text is written for a unit; a bare number is an index, no unit."""
    return not (text.isdigit() or text in ("", "-")) and units.is_written(text)


def heading(text: str) -> tuple[str, str]:
    """Name and unit of a column: ``acc (m/s^2)``, ``acc [g]``, ``t / s``, ``U/V``, ``t_ms``."""
    text = _UNCERTAIN.sub("", " ".join(text.split()))
    run, name = clocks.of_run(text)
    if run and text.endswith(run):  # Time (s) Run #2
        stem, unit = heading(name)
        return (f"{stem} {run}", unit) if unit else (text, "")
    for pattern in (_BRACKETS, _OVER):
        match = pattern.fullmatch(text)
        if match and clocks.may_be_time(match[1]) and clocks.spelled(match[2]):
            return match[1].strip(), clocks.spelled(match[2])
    for pattern in (_BRACKETS, _NO_UNIT, _SLASH, _SLASHED):
        match = pattern.fullmatch(text)
        if match and match[1] and (pattern is _NO_UNIT or is_unit(match[2])):
            return match[1].strip(" /") or text, ("1" if pattern is _NO_UNIT else match[2])
    match = _SUFFIXED.fullmatch(text)
    if match and not endings.is_several(text, f"_{match[2]}"):
        return match[1], _SUFFIXES[match[2]]
    match = _WITHIN.fullmatch(text)
    if match and is_unit(match[2]):
        return f"{match[1]} {match[3]}", match[2]
    match = None if is_unit(text) else _DIN.fullmatch(text) or _WORD_OVER.fullmatch(text)
    if match and is_unit(match[2].strip("()")):
        return match[1], match[2].strip("()")
    return text, ""


def headings(
    cells: Sequence[str], units_below: Sequence[str] = (), keep: Collection[str] = ()
) -> list[tuple[str, str]]:
    """Names and units of all columns, each name once.

    Args:
        cells: the header, cell by cell.
        units_below: units of a row below, empty where there is none.
        keep: names that a mapping uses; a heading that is one of them stays whole.
    """
    heads = []
    fulls = [" ".join(cell.split()) for cell in cells]
    counting = _counting(fulls)
    for i, full in enumerate(fulls):
        name, unit = heading(full)
        below = units_below[i] if i < len(units_below) else ""
        below = below.strip(" ()[]{}<>") or ("1" if below.strip() else "")
        if below:
            name, unit = full, below
        elif full in keep or full in counting:
            name, unit = full, "" if full in counting else unit
        heads.append((name or f"column_{i + 1}", unit, full))
    # two headings that differ in their unit alone stay whole
    apart: dict[str, set[str]] = {}
    for name, _, full in heads:
        apart.setdefault(name, set()).add(full)
    whole = [full if len(apart[name]) > 1 else name for name, _, full in heads]
    return list(zip(told_apart(whole), (unit for _, unit, _ in heads), strict=True))


def labelled(labels: Sequence[tuple[str, str]]) -> tuple[tuple[str, str], ...]:
    """Names and units of values with labels; a unit behind the value goes before one in its label.

    Args:
        labels: what stands before a value, and the unit behind it.
    """
    names = headings([label for label, _ in labels], [unit for _, unit in labels])
    return tuple(names)


def _counting(fulls: Sequence[str]) -> set[str]:
    """Headings whose ``[1]`` counts, beside ``[2]``, or whose ``(A)`` does, beside ``(B)``."""
    marks: dict[str, set[str]] = {}
    found = [match for full in fulls if (match := _ONE_LETTER.fullmatch(full))]
    for match in found:
        marks.setdefault(match[1], set()).add(match[2])
    counts = {
        mark for kind in marks.values() for mark in kind if mark.isdigit() or not is_unit(mark)
    }
    return {match[0] for match in found if (marks[match[1]] & counts) - {match[2]}}


def about_of(lines: Sequence[str]) -> dict[str, str]:
    """What lines above a table say: ``key: value``, ``key = value`` or ``key,value``."""
    about: dict[str, str] = {}
    for line in lines:
        text = line.strip().lstrip("#%/!").strip().strip('"')
        match = re.match(r"([^:=,;\t]{1,60}?)\s*[:=,;\t]\s*(.+)", text)
        if match:
            about.setdefault(match[1].strip(' "'), match[2].strip(' ",;:=\t')[:400])
        elif text.strip(",;\t "):
            about.setdefault(f"remark {len(about) + 1}", text.strip(",;\t ")[:400])
    return about
