"""Reads the rows of a text table in blocks of whole lines.

Each line is split by itself, so that every fault has its line; the columns of a block are then
converted at once. The parser of pandas needs a third of the time (0.8 s of 2.5 s for 100 MB),
but takes short rows and empty lines in silence: it could only stand beside this one.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import console
from simcompare.hardware.logs.text import source as _source
from simcompare.hardware.logs.text.cell import COMMENTS, is_nmea, kind_of, split
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.logs.text.state import Faults, State, Table
from simcompare.hardware.logs.text.values import Values
from simcompare.hardware.raw import RawColumn, Spool
from simcompare.model.trajectory import Array

#: faults after which nothing more is read
_MAX_FAULTS = 100_000
#: characters of a line that may be a row
_MAX_ROW = 1 << 20
#: rows that tell how many decimals the numbers of a column have, and how few tell nothing
_COMPARED, _MIN_COMPARED = 100, 5

#: whole lines that are no rows, by the column that they stand for in the place of one
_LONG, _RAGGED, _REMARK = -3, -2, -1
#: those that are passed over where they are few, and what that is called
_PASSED_OVER = {_RAGGED: "ragged_row", _REMARK: "remark_line"}
#: lines among the rows that are few
_FEW = 0.1
#: what is no row or number: its line, its column (below 0 for a whole line), the cell or the fault
_Odd = tuple[int, int, str]


def read(
    source: _source.Source,
    layout: Layout,
    *,
    joined: bool = False,
    spare: Collection[str] | None = None,
    missing: Collection[str] = (),
) -> Table:
    """Reads all rows.

    Args:
        source: the text.
        layout: how it is written.
        joined: whether a column of dates goes with one of times of day, which then do not wrap.
        spare: columns that nobody asks for; one that holds a fault is left out, as is any that
            holds nothing but remarks. ``None`` where every column has its place.
        missing: what stands in cells where nothing was measured, beside what does everywhere.

    Raises:
        InputError: rows that cannot be read (20 of them by name), or none at all.
    """
    reader = _Reader(source, layout, joined, spare)
    reader.values.missing = frozenset(missing)
    return reader.table()


class _Reader:
    def __init__(
        self, source: _source.Source, layout: Layout, joined: bool, spare: Collection[str] | None
    ) -> None:
        self.source = source
        self.header = layout.header.strip()
        self.state, self.faults = State(), Faults(source.label)
        self.last_row = 0
        self.values = Values(layout, self.state, joined)
        self.spool: Spool | None = None
        self.used = [k for k, kind in enumerate(layout.kinds) if kind not in ("text", "empty")]
        self.remarks = spare is not None
        self.spare = {k for k, (name, _) in enumerate(layout.names) if name in (spare or ())}
        self.odd: list[_Odd] = []
        self.filled: set[int] = set()  # columns that hold a number so far
        self.left: dict[int, _Odd] = {}  # columns that are left out, for what stands in them

    @property
    def layout(self) -> Layout:
        """How the table is written, as far as its rows have told."""
        return self.values.layout

    def table(self) -> Table:
        state, layout = self.state, self.layout
        for block in _source.blocks(self.source, layout.first_line):
            self._take(block)
            if len(self.odd) > _MAX_FAULTS:
                break
        self._settle_odd()
        for text in self.values.unclear_dates():
            self.faults.add(text)
        self.faults.finish("at least " if len(self.odd) > _MAX_FAULTS else "")
        if self.spool is None or not len(self.spool):
            raise InputError(
                self.source.label,
                [state.truncated or f"line {layout.first_line}: no rows follow; expected numbers"],
            )
        return self._made(self.spool.columns())

    # ---- lines become rows ----------------------------------------------------------------------

    def _take(self, block: _source.Block) -> None:
        """Adds the rows of one block."""
        rows: list[list[str]] = []
        numbers: list[int] = []
        last = block.line + len(block.lines) - 1
        for at, line in enumerate(block.lines, start=block.line):
            reason = self._skipped(line)
            if reason:
                self.state.skip(reason, at)
                continue
            cells = split(line, self.layout.separator)
            if len(cells) != len(self.layout.kinds):
                cells = self._padded(cells)
            if at == last and not block.ended and self._is_cut_off(at, line, cells):
                continue
            if len(line) > _MAX_ROW:
                size = len(line.encode())
                self.odd.append((at, _LONG, f"has {size} bytes, which is no row of a table"))
            elif len(cells) != len(self.layout.kinds):
                fault = f"has {len(cells)} cells, expected {len(self.layout.kinds)}"
                self.odd.append((at, _REMARK if _is_remark(cells) else _RAGGED, fault))
            else:
                rows.append(cells)
                numbers.append(at)
        if rows:
            self._add(rows, numbers)

    def _settle_odd(self) -> None:
        """Lines that are no rows are passed over where they are few; all else is a fault."""
        count = 0 if self.spool is None else len(self.spool)
        lines = [(line, k) for line, k, _ in self.odd if k in _PASSED_OVER]
        end = self.last_row
        between = [line for line, k in lines if k != _REMARK or line < end]
        if len(lines) < len(self.odd) or len(between) > count * _FEW:
            for fault in sorted(self.odd):
                self.faults.add(self.values.fault(*fault, told=self.faults.count > 0))
            return
        for line, k in lines:
            self.state.skip(_PASSED_OVER[k], line)

    def _skipped(self, line: str) -> str:
        bare = line.strip()
        if not bare:
            return "blank_line"
        if bare == self.header:
            return "header_repeated"
        if console.BOOT.match(bare):
            return "remark_line"
        if is_nmea(bare):
            return "nmea_line"
        return "comment_line" if bare.startswith(COMMENTS) else ""

    def _padded(self, cells: list[str]) -> list[str]:
        width = len(self.layout.kinds)
        while len(cells) > width and not cells[-1].strip():
            cells.pop()
        if len(cells) > width and self.layout.kinds[-1] == "text":  # a text with separators
            return cells[:width]
        return cells + [""] * (width - len(cells)) if self.layout.short_rows else cells

    def _is_cut_off(self, at: int, line: str, cells: Sequence[str]) -> bool:
        """Whether the last line, which has no end, is no whole row."""
        width = len(self.layout.kinds)
        if len(cells) < width or self._is_cut(cells):
            reason = f"{len(cells)} of {width} cells" if len(cells) < width else repr(line[-20:])
        elif self._is_short(at, cells[-1]):
            reason = f"{cells[-1].strip()!r} has fewer decimals than all above"
        else:
            self.state.no_end = at
            return False
        self.state.truncated = f"line {at} ends in the middle ({reason}); it was left out"
        self.state.skip("cut", at)
        return True

    def _is_cut(self, cells: Sequence[str]) -> bool:
        """Whether the last cell of the last line is no whole number."""
        kind, cell = self.layout.kinds[-1], cells[-1].strip()
        if kind == "number":
            value = _cell.number(cell, self.layout.decimal, self.layout.thousands)
            return value is None or cell in ("", "-")
        return kind == "list" and not cell.endswith(("]", ")"))

    def _is_short(self, line: int, cell: str) -> bool:
        """Whether a number has fewer decimals than those above, which all have as many."""
        layout = self.layout
        if layout.kinds[-1] != "number":
            return False
        first = layout.first_line
        above = self.source.head_from(first)[: min(line - first, _COMPARED)]
        cells = [split(text, layout.separator) for text in above if text.strip()]
        usual = {
            _decimals(row[-1], layout.decimal) for row in cells if len(row) == len(layout.kinds)
        }
        last = _decimals(cell, layout.decimal)
        return len(cells) >= _MIN_COMPARED and len(usual) == 1 and last < usual.pop()

    # ---- rows become numbers --------------------------------------------------------------------

    def _add(self, rows: list[list[str]], numbers: list[int]) -> None:
        if not self.values.layout.decided:
            self.values.decide(rows)
        columns = list(zip(*rows, strict=True))
        odd: list[_Odd] = []
        parts = [self._column(k, columns[k], numbers, odd) for k in self.used]
        if odd:
            self._add_without_remarks(rows, numbers, odd)
            return
        self.last_row = numbers[-1]
        values = np.column_stack(parts)
        if self.spool is None:
            self.spool = Spool(values.shape[1])
        self.spool.append(values)

    def _add_without_remarks(
        self, rows: list[list[str]], numbers: list[int], odd: list[_Odd]
    ) -> None:
        """Adds the rows but those that only hold words and empty cells."""
        cells = dict(zip(numbers, rows, strict=True))
        here = {line for line, _, _ in odd if line in cells}
        remarks = {line for line in here if _is_remark(cells[line]) and "" in cells[line]}
        self.odd += [(line, _REMARK, "holds words, no numbers") for line in sorted(remarks)]
        self.odd += [fault for fault in odd if fault[0] not in remarks]
        if all(line in remarks for line, _, _ in odd):
            kept = [line for line in numbers if line not in remarks]
            if kept:
                self._add([cells[line] for line in kept], kept)

    def _column(
        self, k: int, cells: Sequence[str], numbers: list[int], odd: list[_Odd]
    ) -> Array:  # fmt: skip
        """The values of all cells of a column; those that are odd are noted."""
        made = self.values.column(k, cells, numbers)
        if made is not None:
            if k not in self.filled and np.isfinite(made).any():
                self.filled.add(k)
                odd += [self.left.pop(k)] if k in self.left and k not in self.spare else []
            return made
        one_by_one = [
            self.values.column(k, cells[i : i + 1], numbers[i : i + 1]) for i in range(len(cells))
        ]
        wrong = [
            (number, k, cell)
            for number, cell, value in zip(numbers, cells, one_by_one, strict=True)
            if value is None
        ]
        known = [value for value in one_by_one if value is not None]
        if k in self.spare or self._only_remarks(k, known, wrong):
            self.left.setdefault(k, wrong[0])
            shape = (len(cells), self.state.lengths.get(k, 1))
            return np.full(shape if self.layout.kinds[k] == "list" else len(cells), np.nan)
        odd += wrong
        return np.concatenate(known or [np.empty(0)])

    def _only_remarks(self, k: int, known: list[Array], wrong: list[_Odd]) -> bool:
        """Whether a column held nothing so far, and now nothing but words."""
        return (
            self.remarks and self.layout.kinds[k] == "number" and k not in self.filled
            and not any(np.isfinite(value).any() for value in known)
            and all(kind_of(cell) == "text" for _, _, cell in wrong)
        )  # fmt: skip

    # ---- the end ------------------------------------------------------------------------------

    def _made(self, arrays: list[Array]) -> Table:
        layout, state = self.layout, self.state
        columns: list[RawColumn] = []
        ignored: dict[str, str] = {}
        arrays_left = iter(arrays)
        for k, (kind, (name, unit)) in enumerate(zip(layout.kinds, layout.names, strict=True)):
            if kind == "list":
                for i in range(state.lengths[k]):
                    columns.append(RawColumn(f"{name}[{i}]", next(arrays_left), unit))
            elif kind in ("text", "empty"):
                text = self._example(k)
                ignored[name or f"column_{k + 1}"] = text if kind == "text" else "is empty"
            elif k in self.left:
                next(arrays_left)
                line, _, cell = self.left[k]
                ignored[name] = f"holds text such as {cell.strip()[:60]!r} (line {line})"
            else:
                columns.append(RawColumn(name, next(arrays_left), "s" if kind == "date" else unit))
        origins = {layout.names[k][0]: origin for k, origin in state.origins.items()}
        rows = state.rows(layout.first_line, len(arrays[0]))
        return Table(columns, layout.first_line, rows, state.truncated, state.repairs(layout),
                     ignored, origins)  # fmt: skip

    def _example(self, k: int) -> str:
        """The first text of a column."""
        for line in self.source.head_from(self.layout.first_line):
            cells = split(line, self.layout.separator)
            if k < len(cells) and cells[k].strip():
                return f"holds text such as {cells[k].strip()[:40]!r}"
        return "holds text"


def _is_remark(cells: Sequence[str]) -> bool:
    """Whether a line only holds words, so that no measured value is lost with it."""
    return not any(kind_of(cell) in ("number", "date", "list") for cell in cells)


def _decimals(cell: str, mark: str) -> int:
    """Digits behind the decimal mark; an exponent counts as none."""
    digits = cell.strip().partition(mark)[2]
    return len(digits) if digits.isdigit() else 0
