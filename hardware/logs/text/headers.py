"""The line of names above a table, the units below it, and the groups above it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from simcompare.errors import InputError
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import clocks, groups
from simcompare.hardware.logs.text.cell import is_comment, kind_of, split
from simcompare.hardware.logs.text.source import Source

#: lines above the rows that are looked at
_LOOKED_AT = 50
#: names of a last column that most rows leave out
_REMARKS = ("comment", "comments", "remark", "remarks")


@dataclass(frozen=True)
class Header:
    """What stands above the rows.

    Attributes:
        line: of the names, counted from 0 in the head; ``None`` where there are none.
        names: of the columns.
        units: of a line of units, empty where there is none.
        more: names for which the rows have no cell.
    """

    line: int | None = None
    names: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    more: int = 0


def find(
    source: Source, lines: Sequence[str], first: int, separator: str, kinds: Sequence[str],
    rows: Sequence[Sequence[str]],
) -> Header:  # fmt: skip
    """The header of a table.

    Args:
        source: the text.
        lines: its first ones.
        first: the first row among these.
        separator: of its cells.
        kinds: what the columns hold.
        rows: cells of some rows.

    Raises:
        InputError: the names cannot be those of the columns.
    """
    width = len(kinds)
    every = [i for i in range(first - 1, -1, -1) if lines[i].strip()][:_LOOKED_AT]
    cells = {i: _cells(lines[i], separator, width) for i in every}
    # a remark is passed over unless it is the header itself
    near = [i for i in cells if not is_comment(lines[i]) or len(cells[i]) == width > 1]
    near = [i for i in near if not _is_dated(cells[i], kinds)][:2]
    if not near:
        return Header()
    wanted = (width, width - (kinds[-1] == "empty"))
    fits = [len(cells[i]) in wanted for i in near]
    units = len(near) > 1 and all(fits) and is_units_row(cells[near[0]], cells[near[1]])
    if not fits[0]:
        names = cells[near[0]]
        if is_comment(lines[near[0]]) or len(names) < min(width, 2):
            return Header()
        at = source.first + near[0]
        return replace(_other_width(source.label, at, names, separator, kinds, rows), line=near[0])
    line = near[1] if units else near[0]
    above = [_group_line(lines[i], separator, width) for i in range(line - 1, -1, -1)]
    names = _wide(lines[line], separator, width)
    return Header(line, *groups.named(names, cells[near[0]] if units else [], above))


def _other_width(
    label: str, at: int, names: list[str], separator: str, kinds: Sequence[str],
    rows: Sequence[Sequence[str]],
) -> Header:  # fmt: skip
    """Names that are one too few or too many, where the rows tell which."""
    width = len(kinds)
    if len(names) == width - 1 and _counts([row[0] for row in rows]):
        return Header(None, ["index", *names])
    dated = [k for k, kind in enumerate(kinds) if kind == "date" and k < len(names)]
    noted = names[-1].strip().lower() in _REMARKS  # LabVIEW names it, whether it holds any or not
    if len(names) == width + 1 and (noted or (dated and _all_times(names, dated))):
        return Header(None, names, more=1)
    if names[0].strip()[:1] in tuple("+-.0123456789"):  # a console was opened within a row
        return Header()
    cure = "give every column one name"
    if separator == "," and width == 2 * len(names):
        cure = "the comma seems to be the decimal mark too; export again with another separator"
    text = f"the header (line {at}) has {len(names)} cells but the rows below have"
    raise InputError(label, [f"{text} {width}; {cure}"])


def _is_dated(cells: Sequence[str], kinds: Sequence[str]) -> bool:
    """Whether a line begins as the rows do, with a date: words behind a stamp name nothing."""
    return kinds[0] == "date" and bool(cells) and kind_of(cells[0]) == "date"


def _all_times(names: Sequence[str], places: Sequence[int]) -> bool:
    return all(clocks.is_time(names[k]) for k in places)


def _counts(cells: Sequence[str]) -> bool:
    """Whether cells number the rows, as the index does that pandas and R write."""
    if len(cells) < 2 or not all(cell.strip().isdecimal() for cell in cells):
        return False
    first = int(cells[0])
    return first in (0, 1) and [*map(int, cells)] == [*range(first, first + len(cells))]


def _cells(line: str, separator: str, width: int) -> list[str]:
    """Cells of a header, which may be a remark and may end with separators more or less."""
    cells = split(line, separator)
    if is_comment(line) and not line.lstrip().startswith("%time"):
        cells = split(line.lstrip(" #%/!"), separator)
    if separator == " " and len(cells) != width:
        wide = re.split(r"\t+|\s{2,}|\s*[,;]\s*", line.strip(" #%/!\t"))
        cells = wide if len(wide) == width else cells
    while len(cells) > width and not cells[-1].strip():
        cells.pop()
    return groups.of_markers(cells, width)


def _wide(line: str, separator: str, width: int) -> list[str]:
    """Cells of a line of a header, as many as there are columns."""
    cells = _cells(line, separator, width)
    short = separator != " " and len(cells) < width
    return cells + [""] * (width - len(cells)) if short else cells


def _group_line(line: str, separator: str, width: int) -> list[str]:
    """Cells of a line that may group columns; none where it is one remark."""
    cells = _wide(line, separator, width)
    return [] if is_comment(line) and sum(bool(cell.strip()) for cell in cells) < 2 else cells


def is_units_row(cells: Sequence[str], above: Sequence[str]) -> bool:
    """Whether a line holds the units of the names above it."""
    # channels may be counted, as in Frame,Sub Frame,1,2 above ,,V,V
    named = any(kind_of(cell) == "text" for cell in above)
    if not named or any(kind_of(cell) == "number" for cell in cells):
        return False
    plain = [cell.strip() for cell in cells]
    bare = [text.strip("()[]{}<>") for text in plain]
    bracketed = sum(text[0] in "([{<" for text in plain if text)
    known = sum(_cell.is_unit(text) for text in bare)
    full = sum(bool(text) for text in plain)
    return full > 0 and (bracketed == full or known == full)
