"""Text exports of Tracker (video analysis): one track, or several after ``#multi:``.

    ,mass A,,
    t,x,y,
    0.000000000E0,1.245986911E1,-3.1E-2,

Tracker writes numbers without units: times are in seconds, and lengths in the unit of its
calibration, a metre unless somebody chose another one.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import sniff
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text import table as _table
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import Head, RawColumn, RawLog, RawStream
from simcompare.model.recording import INFO, Clock, Repair

TITLE = "a text export of Tracker"
#: rule of the repair that says that units were assumed
NO_UNITS = "no_units"

#: variables that Tracker exports, as it spells them
_VARIABLES = re.compile(
    r"t|x|y|r|v|a|L|K|p|dx|dy|m|mass|theta|θ|θ_?\{?[rvapω]\}?|omega|ω|alpha|α|step|frame|n"
    r"|[rvapθ]_?\{?(?:x|y|mag|ang|θ)\}?|pixel_?\{?[xy]\}?|path ?length|rotations"
)
#: units of lengths and what follows from them, as Tracker has them by default; it gives angles in
#: degrees or radians
_UNITS = (
    (re.compile(r"x|y|r|dx|dy|r_\{?(?:x|y|mag)\}?|path ?length"), "m"),
    (re.compile(r"v|v_\{?(?:x|y|mag)\}?"), "m/s"),
    (re.compile(r"a|a_\{?(?:x|y|mag)\}?"), "m/s^2"),
)
_ASSUMED = [unit for _, unit in _UNITS]
#: those that count, so that they have no unit
_COUNTS = ("step", "frame", "n", "pixelx", "pixely", "pixel_x", "pixel_y", "rotations")


def recognises(head: Head) -> int:
    """Certain with ``#multi:``; high with a line of one name above ``t`` and variables."""
    if head.members:
        return 0
    lines = _source.head_lines(head.start)
    if not lines or len(lines) < 3:
        return 0
    if lines[0].strip().lower().startswith("#multi:"):
        return 95
    return 80 if _separator(lines, 0) else 0


def read(path: Path, mapping: Mapping) -> RawLog:
    """Reads all tracks; those of one export share its clock and so its stream.

    Raises:
        InputError: not laid out as Tracker does, or with cells that are no numbers.
    """
    source = _source.source_of(path)
    lines = source.head
    multi = _line(lines, 0).strip().lower().startswith("#multi:")
    at = 1 if multi else 0
    separator = _separator(lines, at)
    if not separator:
        raise InputError(
            str(path),
            [f"line {at + 2}: {_line(lines, at + 1)[:60]!r} is no header of Tracker; expected the"
             " name of the track in the line above, and t with variables such as x and y here"],
        )  # fmt: skip
    layout, tracks = _layout(str(path), lines, at, separator)
    table = _table.read(source, layout)
    repairs = [*source.repairs, *table.repairs]
    for column in table.columns:
        column.defined = True  # what else stands in its name is that of a track, such as mass_A
    assumed = [
        c for c in table.columns if c.unit in _ASSUMED and not mapping.of_column("log", c.name)
    ]
    text = "Tracker writes no units; times were taken as seconds, lengths as metres"
    repairs += [Repair(NO_UNITS, INFO, text, "log", column.name) for column in assumed]
    stream = RawStream(
        "log", table.columns, "t", clock=Clock("video frames"), first_row=table.first_row,
        rows=table.rows, truncated=table.truncated, counter=_counter(table.columns),
    )  # fmt: skip
    return RawLog([stream], repairs=repairs, ignored=table.ignored,
                  about={"tracks": ", ".join(tracks)})  # fmt: skip


def _line(lines: Sequence[str], at: int) -> str:
    return lines[at] if at < len(lines) else ""


def _separator(lines: Sequence[str], at: int) -> str:
    """What separates the header below the line of names, empty where there is no such header."""
    header = _line(lines, at + 1)
    for separator in "\t;, ":
        cells = [cell.strip() for cell in _cell.split(header, separator)]
        if len(cells) < 2 or cells[0] != "t":
            continue
        names = [cell.strip() for cell in _cell.split(_line(lines, at), separator)]
        if separator == " ":
            names = [_line(lines, at).strip()]
        known = [bool(_VARIABLES.fullmatch(c)) for c in cells[1:] if c]
        # the line above holds names alone: no remark, no second header and no numbers
        named = any(names) and not any(_cell.number(n) is not None for n in names if n)
        named = named and not re.search(r"^\s*[#%]|[:=]", _line(lines, at))
        one = separator != " " and sum(map(bool, names)) == 1
        if named and names[0] != "t" and known and (all(known) or one):
            return separator
    return ""


def _layout(label: str, lines: Sequence[str], at: int, separator: str) -> tuple[Layout, list[str]]:
    """The layout of the rows, and the names of the tracks."""
    above = [cell.strip() for cell in _cell.split(lines[at], separator)]
    cells = [cell.strip() for cell in _cell.split(lines[at + 1], separator)]
    if separator == " ":
        above = [lines[at].strip()]
    while cells and not cells[-1]:
        cells.pop()
    tracks = [name for name in above if name]
    names = _named(above, cells, several=len(tracks) > 1)
    return sniff.below_header(label, lines, at + 2, names, separator), tracks


def _named(above: Sequence[str], cells: Sequence[str], *, several: bool) -> list[tuple[str, str]]:
    """Names and units of the columns; with several tracks the track's name stands in front."""
    columns = [("t", "s")]
    track = ""
    for k, cell in enumerate(cells[1:], start=1):
        if k < len(above) and above[k]:
            track = above[k]
        elif k == 1 and above[0]:  # without a leading separator the name stands above t
            track = above[0]
        name, unit = _cell.heading(cell)
        unit = unit or ("1" if name in _COUNTS else _usual_unit(name))
        columns.append((f"{track} {name}" if several else name or f"column_{k + 1}", unit))
    return columns


def _usual_unit(name: str) -> str:
    """The unit of a variable where nobody chose another one, empty for angles and the like."""
    usual = next((unit for pattern, unit in _UNITS if pattern.fullmatch(name)), "")
    return "s" if name == "t" else usual


def _counter(columns: Sequence[RawColumn]) -> str | None:
    """The column that counts frames by one."""
    for column in columns:
        if column.name in ("step", "frame", "n") and np.all(np.diff(column.values) == 1):
            return column.name
    return None
