"""How a table of text is laid out: separator, decimal mark, header, units, kinds of columns."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from itertools import islice

from simcompare.errors import InputError
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import headers
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text.cell import is_comment, kind_of, split
from simcompare.hardware.logs.text.dates import DateStyle, style_of
from simcompare.hardware.logs.text.marks import marks, without_commas

#: separators that are tried, the surest first; a blank stands for any run of them
SEPARATORS = "\t;|, "
_MAX_LINES = 1000
#: rows below a known header that are looked at
_SAMPLE = 500


@dataclass(frozen=True)
class Layout:
    """How to read a table.

    Attributes:
        separator: one character; a blank stands for any run of them.
        first_line: number of the first row, counted from 1.
        kinds: of each column: "number", "flag", "list", "date", "text" or "empty".
        names: name and unit of each column.
        decimal: decimal mark.
        thousands: mark between groups of three digits, empty where there is none.
        decided: whether a mark was seen at all; if not, the first one that comes decides.
        header: the line of names as it stands in the file, empty where there is none.
        preamble: lines above the header.
        styles: how columns of dates write them.
        hollow: columns that hold nothing so far.
        short_rows: whether rows may end early.
    """

    separator: str
    first_line: int
    kinds: tuple[str, ...]
    names: tuple[tuple[str, str], ...]
    decimal: str = "."
    thousands: str = ""
    decided: bool = True
    header: str = ""
    preamble: tuple[str, ...] = ()
    styles: dict[int, DateStyle] = field(default_factory=dict)
    hollow: tuple[int, ...] = ()
    short_rows: bool = False


def sniff(source: _source.Source, keep: Collection[str] = ()) -> Layout:
    """The layout of a table with any separator and any header.

    Args:
        source: the text.
        keep: names of columns that a mapping uses.

    Raises:
        InputError: there is no table, or it can be read in two ways.
    """
    full = (i for i, line in enumerate(source.head) if line.strip() and not is_comment(line))
    rows = list(islice(full, _MAX_LINES))
    lines = source.head[: rows[-1] + 1 if len(rows) == _MAX_LINES else None]
    at = source.first  # number of the first line
    if len(rows) > 2 and source.complete and _is_cut(lines, rows):
        rows = rows[:-1]
    rows = _without_text_below(lines, rows)
    separator = _separator([lines[i] for i in rows])
    cells = {i: split(lines[i], separator) for i in rows}
    width = _width([cells[i] for i in rows])
    kinds = _kinds([cells[i] for i in rows if len(cells[i]) == width][-len(rows) // 2 - 1 :], width)
    first = _first(rows, cells, kinds)
    if first is None and _is_header_alone(cells, width):
        shown = ", ".join(cells[rows[0]])[:80]
        raise InputError(
            source.label,
            [f"line {rows[0] + at}: has a header ({shown}) and no rows; the log ends before its"
             " first sample"],
        )  # fmt: skip
    if first is None or not {"number", "list"} & set(kinds):
        raise InputError(
            source.label,
            ["holds no rows of numbers; expected columns of numbers with one separator"
             f" (looked at the first {len(lines)} lines)"],
        )  # fmt: skip
    first = _with_bad_rows_above(first, rows, cells, kinds)
    kinds = _kinds([cells[i] for i in rows if i >= first and len(cells[i]) == width], width)
    body = [(i + at, cells[i]) for i in rows if i >= first and len(cells[i]) == width]
    header = headers.find(source, lines, first, separator, kinds, [row for _, row in body])
    names = _cell.headings((header.names + [""] * width)[: width + header.more], header.units, keep)
    top = first if header.line is None else header.line
    if separator == ",":
        kinds = without_commas(body, kinds)
    decimal, thousands, decided = marks(source.label, body, kinds, names)
    styles = {k: s for k in range(width) if kinds[k] == "date"
              for s in [style_of([row[k] for _, row in body])] if s}  # fmt: skip
    return Layout(
        separator,
        first + at,
        (*(_final(kinds, k, header.names, styles) for k in range(width)), *["empty"] * header.more),
        tuple(names),
        decimal,
        thousands,
        decided,
        "" if header.line is None else lines[header.line],
        tuple(lines[:top]),
        styles,
        tuple(k for k in range(width) if kinds[k] == "empty"),
        bool(header.more),
    )


def _is_header_alone(cells: dict[int, list[str]], width: int) -> bool:
    """Whether there are names, perhaps with units below them, and nothing else."""
    table = list(cells.values())
    texts = [cell.strip() for row in table for cell in row]
    return (
        width > 1
        and (len(table) == 1 or (len(table) == 2 and headers.is_units_row(table[1], table[0])))
        and all(len(row) == width for row in table)
        and all(0 < len(text) <= 40 and kind_of(text) == "text" for text in texts)
    )


def _is_cut(lines: Sequence[str], rows: Sequence[int]) -> bool:
    """Whether the last row has no line end, so that it may be cut."""
    return rows[-1] == len(lines) - 1


def _without_text_below(lines: Sequence[str], rows: list[int]) -> list[int]:
    """Lines up to the last one that holds more numbers than words."""
    for count in range(len(rows), 0, -1):
        kinds = [kind_of(cell) for cell in re.split(r"[,;|\s]+", lines[rows[count - 1]]) if cell]
        if sum(kind in ("number", "date", "list") for kind in kinds) >= len(kinds) / 2:
            return rows[:count]
    return rows


def _separator(lines: Sequence[str]) -> str:
    sample = lines[-200:]
    best, best_score = ",", (-1.0, 0)
    for separator in SEPARATORS:
        table = [split(line, separator) for line in sample]
        width = _width(table)
        fitting = [cells for cells in table if len(cells) == width]
        kinds = [kind_of(cell) for cells in fitting for cell in cells]
        good = sum(kind in ("number", "date", "list", "flag", "empty") for kind in kinds)
        share = len(fitting) / max(len(table), 1) * good / max(len(kinds), 1)
        score = (round(share, 3) if width > 1 else min(round(share, 3), 0.3), width > 1)
        if score > best_score:
            best, best_score = separator, score
    return best


def _width(table: Sequence[Sequence[str]]) -> int:
    """Commonest number of cells in the later half, where the rows are."""
    later = table[len(table) // 2 :]
    return Counter(len(cells) for cells in later).most_common(1)[0][0] if later else 0


def _kinds(rows: Sequence[Sequence[str]], width: int) -> list[str]:
    kinds = []
    for k in range(width):
        counts = Counter(kind_of(row[k]) for row in rows)
        full = sum(counts.values()) - counts["empty"]
        best = max(("number", "date", "list", "flag"), key=lambda kind: counts[kind])
        if not full:
            kinds.append("empty")
        else:
            kinds.append(best if counts[best] >= full / 2 else "text")
    return kinds


def fits(cells: Sequence[str], kinds: Sequence[str]) -> bool:
    """Whether a line is a row: every cell is of its column's kind, and not all are text."""
    if len(cells) != len(kinds):
        return False
    cell_kinds = [kind_of(cell) for cell in cells]
    certain = [s == k for s, k in zip(cell_kinds, kinds, strict=True) if k not in ("text", "empty")]
    return any(certain) and all(
        k == "text" or s in (k, "empty") for s, k in zip(cell_kinds, kinds, strict=True)
    )


def _first(rows: Sequence[int], cells: dict[int, list[str]], kinds: Sequence[str]) -> int | None:
    """The first row that the next line follows as one, so that it is no line of a head."""
    fitting = [fits(cells[i], kinds) for i in rows]
    for k, i in enumerate(rows):
        if fitting[k] and (k + 1 == len(rows) or fitting[k + 1]):
            return i
    return next((i for i, fits in zip(rows, fitting, strict=True) if fits), None)


def _with_bad_rows_above(
    first: int, rows: Sequence[int], cells: dict[int, list[str]], kinds: Sequence[str]
) -> int:
    """The first row, where rows with a fault stand above the first that has none."""
    for i in reversed([i for i in rows if i < first]):
        known = [k for k, kind in enumerate(kinds) if kind in ("number", "date", "list")]
        right = [k for k in known if k < len(cells[i]) and kind_of(cells[i][k]) == kinds[k]]
        numbers = len(right)
        if (
            all(kinds[k] == "date" for k in right)
            or (len(cells[i]) < 2 < len(kinds))
            or numbers < len(known) / 2
        ):
            return first
        first = i
    return first


def _final(
    kinds: Sequence[str], k: int, header: Sequence[str], styles: dict[int, DateStyle]
) -> str:
    if kinds[k] == "date" and k not in styles:
        return "text"
    if kinds[k] == "empty" and k < len(header) and header[k].strip():
        return "number"  # a named column that holds nothing so far
    return kinds[k]


def below_header(
    label: str, lines: Sequence[str], above: int, names: Sequence[tuple[str, str]],
    separator: str = ",",
) -> Layout:  # fmt: skip
    """The layout of rows of numbers whose header has been read already.

    Args:
        label: the file, as messages name it.
        lines: its first ones.
        above: how many of them stand above the rows.
        names: names and units of the columns; those beyond them are empty.
        separator: of the cells.

    Raises:
        InputError: there are no rows, or the comma separates cells and decimals.
    """
    rows = [
        (i + 1, split(line, separator))
        for i, line in enumerate(lines[: above + _SAMPLE])
        if i >= above and line.strip()
    ]
    if not rows:
        raise InputError(label, [f"line {above + 1}: no samples follow the header"])
    filled = max(sum(bool(cell.strip()) for cell in row) for _, row in rows)
    if separator == "," and filled == 2 * len(names):
        raise InputError(
            label,
            [f"line {above + 1}: has {filled} numbers for {len(names)} columns: the comma is the"
             " decimal mark too; export again with a semicolon or tab as delimiter"],
        )  # fmt: skip
    beyond = [cell for _, row in rows for cell in row[len(names) :]]
    empty = 0 if any(map(str.strip, beyond)) else max(len(row) for _, row in rows) - len(names)
    kinds = ["number"] * len(names) + ["empty"] * max(empty, 0)
    full = (*names, *[("", "")] * max(empty, 0))
    header = lines[above - 1] if above else ""
    return Layout(
        separator, rows[0][0], tuple(kinds), full, *marks(label, rows, kinds, full), header=header
    )
