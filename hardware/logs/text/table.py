"""Reads the rows of a text table: fast in large blocks, exactly where a block is not plain.

A block of whole lines goes through the C parser of pandas. Whatever that cannot take, or would take
in silence (short rows, empty lines), goes line by line, so that every fault has its line.
"""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.hardware.logs.text import dates
from simcompare.hardware.logs.text import text as _text
from simcompare.hardware.logs.text.sniff import Layout, doubt, is_comment, mark_of, split
from simcompare.hardware.logs.text.state import State, Table
from simcompare.hardware.raw import RawColumn, Spool
from simcompare.model.trajectory import Array

#: faults after which nothing more is read
_ENOUGH = 100_000
#: bytes of a line that may be a row
_LONGEST_ROW = 1 << 20
#: marks of thousands that are none: pandas would take them out wherever they stand
_MISGROUPED = {
    mark: re.compile(
        rb"\d{4}%s|(?<!\d)0\d*%s|\d%s(?!\d{3}(?!\d))" % ((re.escape(mark.encode()),) * 3)
    )
    for mark in (",", ".")
}
#: rows that tell how many decimals the numbers of a column have, and how few tell nothing
_COMPARED, _FEWEST = 100, 5
_DAY_NS = 86_400 * 10**9


def read(source: _text.Source, layout: Layout, *, joined: bool = False) -> Table:
    """Reads all rows.

    Args:
        source: the text.
        layout: how it is written.
        joined: whether a column of dates goes with one of times of day, which then do not wrap.

    Raises:
        InputError: rows that cannot be read (20 of them by name), or none at all.
    """
    reader = _Reader(source, layout, joined)
    return reader.table()


class _Reader:
    def __init__(self, source: _text.Source, layout: Layout, joined: bool) -> None:
        self.source, self.layout, self.joined = source, layout, joined
        self.state = State()
        self.spool: Spool | None = None
        self.wanted = [k for k, kind in enumerate(layout.kinds) if kind not in ("text", "empty")]

    def table(self) -> Table:
        state, layout = self.state, self.layout
        for block in _text.blocks(self.source, layout.first_line):
            if layout.stop_line and block.line > layout.stop_line:
                break
            self._take(block.until(layout.stop_line))
            if state.count > _ENOUGH:
                break
        self._check_dates()
        if state.count > len(state.faults):
            more = "at least " if state.count > _ENOUGH else ""
            state.faults.append(f"and {more}{state.count - len(state.faults)} more such faults")
        if state.faults:
            raise InputError(self.source.label, state.faults)
        if self.spool is None or not len(self.spool):
            raise InputError(
                self.source.label,
                [state.truncated or f"line {layout.first_line}: no rows follow; expected numbers"],
            )
        return self._made(self.spool.columns())

    def _take(self, block: _text.Block) -> None:
        """One block; a last line without end goes alone, as it may be cut."""
        if not block.count:
            return
        data = block.data
        for old, new in self.layout.swaps:
            data = data.replace(old, new)
        if not block.ended:
            cut = data.rfind(b"\n") + 1
            whole = _text.Block(block.line, data[:cut], block.count - 1, True)
            self._take(replace(whole)) if whole.count else None
            at = block.line + block.count - 1
            self._add(self._slow(_text.Block(at, data[cut:], 1, False)))
        else:
            block = replace(block, data=data)
            rows = self._fast(block, range(block.line, block.line + block.count))
            if rows is None:
                rows = self._fast_without_remarks(block)
            self._add(self._slow(block) if rows is None else rows)
        self.state.last_line = block.line + block.count - 1

    def _add(self, rows: Array) -> None:
        if not len(rows):
            return
        if self.spool is None:
            self.spool = Spool(rows.shape[1])
        self.spool.append(rows)

    # ---- fast: pandas -------------------------------------------------------------------------

    def _fast_without_remarks(self, block: _text.Block) -> Array | None:
        """The block without empty lines, remarks and repeated headers."""
        kept, numbers, gone = [], [], []
        for at, raw in enumerate(block.data.split(b"\n")[: block.count], start=block.line):
            reason = self._skipped(self._decoded(raw))
            if reason:
                gone.append((reason, at))
            else:
                kept.append(raw)
                numbers.append(at)
        if not gone or not kept:
            return None
        data = b"\n".join(kept) + b"\n"
        rows = self._fast(_text.Block(block.line, data, len(kept), True), numbers)
        for reason, at in gone if rows is not None else []:
            self.state.skip(reason, at)
        return rows

    def _decoded(self, raw: bytes) -> str:
        return raw.decode(self.source.body_encoding, errors="replace").rstrip("\r")

    def _fast(self, block: _text.Block, numbers: Sequence[int]) -> Array | None:
        import pandas as pd

        layout = self.layout
        blanks = layout.separator == " "
        if b"\0" in block.data or (not blanks and not self._even(block)):
            return None
        if layout.thousands and _MISGROUPED[layout.thousands].search(block.data):
            return None
        types: dict[int, Any] = {
            k: {"number": np.float64, "integer": np.int64}.get(layout.kinds[k], "str")
            for k in (range(len(layout.kinds)) if blanks else self.wanted)
        }
        try:
            with np.errstate(invalid="ignore"):  # whole numbers too large for 64 bits
                frame = pd.read_csv(
                    io.BytesIO(block.data), header=None, engine="c", dtype=types,
                    sep=r"\s+" if blanks else layout.separator,
                    usecols=None if blanks else self.wanted, decimal=layout.decimal,
                    thousands=layout.thousands or None, na_values=list(_text.MISSING),
                    keep_default_na=False, skip_blank_lines=False, skipinitialspace=True,
                    encoding=self.source.body_encoding, encoding_errors="replace",
                    low_memory=False,
                )  # fmt: skip
        except (ValueError, OverflowError, UnicodeError):
            return None
        if len(frame) != block.count or (blanks and frame.shape[1] != len(layout.kinds)):
            return None
        if blanks and frame[frame.columns[-1]].isna().any():
            return None  # a short row, perhaps
        if not layout.decided and (b"." in block.data):
            self.layout = replace(layout, decided=True)
        return self._assembled({k: frame[k] for k in self.wanted}, numbers)

    def _even(self, block: _text.Block) -> bool:
        """Whether all rows together have as many separators as they must."""
        mark = self.layout.separator.encode()
        expected = (len(self.layout.kinds) - 1) * block.count
        if len(self.layout.kinds) == 1:
            return b"\n\n" not in block.data and b"\n\r\n" not in block.data
        if b'"' not in block.data:
            return _text.count_of(mark, block.data) == expected
        data = np.frombuffer(block.data, dtype=np.uint8)
        outside = np.cumsum(data == ord('"'), dtype=np.int32) % 2 == 0
        return int(np.count_nonzero((data == mark[0]) & outside)) == expected

    # ---- both ---------------------------------------------------------------------------------

    def _assembled(self, cells: dict[int, Any], numbers: Sequence[int]) -> Array | None:
        """Values of rows (n, slots), ``None`` where one is odd; ``numbers`` are their lines."""
        parts: list[Array] = []
        for k in self.wanted:
            kind, column = self.layout.kinds[k], cells[k]
            made: Array | None
            if kind == "number":
                made = np.asarray(column, dtype=np.float64)
            elif kind == "integer":
                made = self._counted(k, np.asarray(column, dtype=np.int64))
            elif kind == "flag":
                made = _text.flags(column)
            elif kind == "list":
                made = self._lists(k, column)
            else:
                made = self._dated(k, column, numbers)
            if made is None:
                return None
            parts.append(made)
        return np.column_stack(parts) if parts else None

    def _counted(self, k: int, values: NDArray[np.int64]) -> Array:
        origin = self.state.origins.setdefault(k, int(values[0]) if len(values) else 0)
        return (values - origin).astype(np.float64)

    def _dated(self, k: int, column: Any, numbers: Sequence[int]) -> Array | None:  # noqa: ANN401
        state, style = self.state, self.layout.styles[k]
        stamps = dates.nanoseconds(column, style)
        if stamps is None:
            return None
        if not len(stamps):
            return np.empty(0)
        if style.kind == "clock" and not self.joined:
            before = state.clock_ns.get(k, int(stamps[0]))
            days = before // _DAY_NS
            steps = np.diff(stamps, prepend=before % _DAY_NS)
            wraps = np.flatnonzero(steps < -_DAY_NS // 2)
            state.midnights += [numbers[i] for i in wraps.tolist()]
            stamps = stamps + (days + np.cumsum(steps < -_DAY_NS // 2)) * _DAY_NS
            state.clock_ns[k] = int(stamps[-1])
        if style.other:
            state.days.update(np.unique(stamps // _DAY_NS).tolist())
            state.examples.setdefault(k, str(next(iter(column))))
        origin = state.origins.setdefault(k, int(stamps[0]))
        return (stamps - origin) / 1e9

    def _lists(self, k: int, column: Any) -> Array | None:  # noqa: ANN401
        """Cells ``[0.1, 0.2]`` as one row of numbers each."""
        texts = [str(cell).strip() for cell in column]
        if not all(text[:1] in ("[", "(") and text[-1:] in ("]", ")") for text in texts):
            return None
        parts = [text[1:-1].replace(";", ",") for text in texts]
        length = self.state.lengths.setdefault(k, parts[0].count(",") + 1 if parts else 0)
        if any(part.count(",") + 1 != length for part in parts):
            return None
        found = [_text.number(cell) for part in parts for cell in part.split(",")]
        if any(value is None for value in found):
            return None
        return np.array(found, dtype=np.float64).reshape(len(parts), length)

    # ---- slow: line by line -------------------------------------------------------------------

    def _slow(self, block: _text.Block) -> Array:
        state = self.state
        found: list[Array] = []
        lines = block.data.split(b"\n")[: block.count]
        for at, raw in enumerate(lines, start=block.line):
            if len(raw) > _LONGEST_ROW:
                state.fault(f"line {at}: has {len(raw)} bytes, which is no row of a table")
                continue
            line = self._decoded(raw)
            reason = self._skipped(line)
            if reason:
                state.skip(reason, at)
                continue
            cells = split(line, self.layout.separator)
            width = len(self.layout.kinds)
            while len(cells) > width and not cells[-1].strip():
                cells.pop()
            if self.layout.short_rows:
                cells += [""] * (width - len(cells))
            if not block.ended and (len(cells) < width or self._is_cut(cells)):
                have = f"{len(cells)} of {width} cells" if len(cells) < width else repr(line[-20:])
                state.truncated = f"line {at} ends in the middle ({have}); it was left out"
                state.skip("cut", at)
                continue
            if not block.ended and self._is_short(at, cells[-1]):
                text = f"{cells[-1].strip()!r} has fewer decimals than all above"
                state.truncated = f"line {at} ends in the middle ({text}); it was left out"
                state.skip("cut", at)
                continue
            state.no_end = 0 if block.ended else at
            if len(cells) != width:
                state.fault(f"line {at}: has {len(cells)} cells, expected {width}")
                continue
            row = self._row(at, cells)
            if row is not None:
                found.append(row)
        return np.concatenate(found) if found else np.empty((0, 0))

    def _skipped(self, line: str) -> str:
        if not line.strip():
            return "blank_line"
        if self.layout.header and line.strip() == self.layout.header.strip():
            return "header_repeated"
        return "comment_line" if is_comment(line) else ""

    def _is_cut(self, cells: Sequence[str]) -> bool:
        """Whether the last cell of the last line is no whole number."""
        kind, cell = self.layout.kinds[-1], cells[-1].strip()
        if kind == "number":
            value = _text.number(cell, self.layout.decimal, self.layout.thousands)
            return value is None or not cell
        return kind == "list" and not cell.endswith(("]", ")"))

    def _is_short(self, line: int, cell: str) -> bool:
        """Whether a number has fewer decimals than those above, which all have as many."""
        layout = self.layout
        if layout.kinds[-1] != "number":
            return False
        first = layout.first_line - 1
        above = self.source.head[first : min(line - 1, first + _COMPARED)]
        cells = [split(text, layout.separator) for text in above if text.strip()]
        usual = {
            _decimals(row[-1], layout.decimal) for row in cells if len(row) == len(layout.kinds)
        }
        own = _decimals(cell, layout.decimal)
        return len(cells) >= _FEWEST and len(usual) == 1 and own < usual.pop()

    def _row(self, line: int, cells: Sequence[str]) -> Array | None:
        """One row as (1, slots), or a fault for every cell that is no number."""
        good: dict[int, Any] = {}
        before = self.state.count
        for k in self.wanted:
            cell, kind = cells[k], self.layout.kinds[k]
            value: Any = [cell]
            if kind == "number":
                value = self._value(line, k, cell)
            elif kind == "integer":
                value = [int(cell)] if re.fullmatch(r"\s*[+-]?\d{1,18}\d?\s*", cell) else None
                value = value if value and abs(value[0]) < 1 << 63 else None
            good[k] = value
            if value is None:
                self._odd(line, k, cell)
        if self.state.count > before:
            return None
        row = self._assembled(good, [line])
        if row is None:
            for k in self.wanted:
                if self._assembled_alone(k, good[k], line) is None:
                    self._odd(line, k, cells[k])
        return row

    def _assembled_alone(self, k: int, cell: Any, line: int) -> Array | None:  # noqa: ANN401
        wanted, self.wanted = self.wanted, [k]
        try:
            return self._assembled({k: cell}, [line])
        finally:
            self.wanted = wanted

    def _value(self, line: int, k: int, cell: str) -> list[float] | None:
        layout = self.layout
        mark = "" if layout.decided else mark_of(cell)
        if mark in (".", ",") and _text.number(cell, mark) is not None:
            self.layout = layout = replace(layout, decimal=mark, decided=True)
        value = _text.number(cell, layout.decimal, layout.thousands)
        return None if value is None else [value]

    def _odd(self, line: int, k: int, cell: str) -> None:
        """The fault of one cell."""
        layout, name = self.layout, self.layout.names[k][0]
        kind = layout.kinds[k]
        if kind == "number" and mark_of(cell) == "?" and layout.decimal == ".":
            self.state.fault(doubt(line, name, cell))
            return
        wanted = {
            "list": f"a list of {self.state.lengths.get(k, 0)} numbers",
            "flag": "true or false",
            "date": f"a date as {layout.styles[k].words}" if k in layout.styles else "a date",
            "integer": "a whole number",
        }.get(kind, "a number" + (" with a decimal comma" if layout.decimal == "," else ""))
        text = f"line {line}, column {name!r}: {cell.strip()[:60]!r} is not {wanted}"
        is_word = kind == "number" and not re.search(r"\d", cell)
        if is_word and not self.state.count:  # mostly it says just that; told once
            text += "; where nothing was measured, leave the cell empty, or delete the line"
        self.state.fault(text)

    # ---- the end ------------------------------------------------------------------------------

    def _check_dates(self) -> None:
        if len(self.state.days) > 1:
            for k, example in self.state.examples.items():
                style, name = self.layout.styles[k], self.layout.names[k][0]
                other = replace(style, order=style.other).words
                self.state.fault(
                    f"column {name!r}: {example!r} may be {style.words} or {other}, and the date"
                    " changes in the log; write dates as 2024-12-31"
                )

    def _made(self, arrays: list[Array]) -> Table:
        layout, state = self.layout, self.state
        columns: list[RawColumn] = []
        ignored: dict[str, str] = {}
        left = iter(arrays)
        for k, (kind, (name, unit)) in enumerate(zip(layout.kinds, layout.names, strict=True)):
            if kind == "list":
                for i in range(state.lengths[k]):
                    columns.append(RawColumn(f"{name}[{i}]", next(left), unit))
            elif kind in ("text", "empty"):
                text = self._example(k)
                ignored[name or f"column_{k + 1}"] = text if kind == "text" else "is empty"
            else:
                columns.append(RawColumn(name, next(left), "s" if kind == "date" else unit))
        origins = {layout.names[k][0]: origin for k, origin in state.origins.items()}
        rows = state.rows(layout.first_line, len(arrays[0]))
        return Table(columns, layout.first_line, rows, state.truncated, state.repairs(layout),
                     ignored, origins)  # fmt: skip

    def _example(self, k: int) -> str:
        line = self.source.head[min(self.layout.first_line, len(self.source.head)) - 1]
        cells = split(line, self.layout.separator)
        return f"holds text such as {cells[k].strip()[:40]!r}" if k < len(cells) else "holds text"


def _decimals(cell: str, mark: str) -> int:
    """Digits behind the decimal mark; an exponent counts as none."""
    digits = cell.strip().partition(mark)[2]
    return len(digits) if digits.isdigit() else 0
