"""The cells of a column become numbers: decimals, whole counts, flags, lists, dates."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import dates
from simcompare.hardware.logs.text.marks import doubt, mark_of
from simcompare.hardware.logs.text.sniff import Layout
from simcompare.hardware.logs.text.state import State
from simcompare.model.trajectory import Array

_WHOLE = re.compile(r"\s*[+-]?\d{1,19}\s*", re.ASCII)
_DAY_NS = 86_400 * 10**9


class Values:
    """Numbers of cells, by the kinds of their columns.

    Args:
        layout: how the table is written; the first decimal mark may decide more of it.
        state: what is known after the blocks so far.
        joined: whether a column of dates goes with one of times of day.
    """

    def __init__(self, layout: Layout, state: State, joined: bool) -> None:
        self.layout, self.state, self.joined = layout, state, joined
        self.missing: frozenset[str] = frozenset()
        self._used = [k for k, kind in enumerate(layout.kinds) if kind not in ("text", "empty")]

    def decide(self, rows: list[list[str]]) -> None:
        """The first number with a mark that can only be the decimal one decides which it is."""
        for row in rows:
            for k in self._used:
                mark = mark_of(row[k]) if self.layout.kinds[k] == "number" else ""
                if mark in (".", ",") and _cell.number(row[k], mark) is not None:
                    self.layout = replace(self.layout, decimal=mark, decided=True)
                    return

    def column(self, k: int, cells: Sequence[str], numbers: list[int]) -> Array | None:
        """The values of some cells of a column, ``None`` where one is odd."""
        kind = self.layout.kinds[k]
        if self.missing:
            cells = ["" if cell.strip() in self.missing else cell for cell in cells]
        if kind == "number":
            return _cell.numbers(cells, self.layout.decimal, self.layout.thousands)
        if kind == "integer":
            return self._counted(k, cells)
        if kind == "flag":
            return _cell.flags(cells)
        return self._lists(k, cells) if kind == "list" else self._dated(k, cells, numbers)

    def _counted(self, k: int, cells: Sequence[str]) -> Array | None:
        """Whole numbers from their first one on, as a float would round them."""
        if not all(map(_WHOLE.fullmatch, cells)):
            return None
        counts = [int(cell) for cell in cells]
        origin = self.state.origins.setdefault(k, counts[0])
        return np.array([count - origin for count in counts], dtype=np.float64)

    def _dated(self, k: int, cells: Sequence[str], numbers: Sequence[int]) -> Array | None:
        state, style = self.state, self.layout.styles[k]
        stamps = dates.nanoseconds(cells, style)
        if stamps is None:
            return None
        known = stamps != dates.NOT_KNOWN
        if not known.all():
            seconds = np.full(len(stamps), np.nan)
            if known.any():
                at = np.flatnonzero(known).tolist()
                some = self._dated(k, [cells[i] for i in at], [numbers[i] for i in at])
                if some is None:
                    return None
                seconds[known] = some
            return seconds
        if style.period_ns and not self.joined:
            stamps = self._unwrapped(k, stamps, style.period_ns, numbers)
        if style.other:
            state.days.update(np.unique(stamps // _DAY_NS).tolist())
            state.examples.setdefault(k, cells[0])
        origin = state.origins.setdefault(k, int(stamps[0]))
        return (stamps - origin) / 1e9

    def _unwrapped(
        self, k: int, stamps: NDArray[np.int64], period: int, numbers: Sequence[int]
    ) -> NDArray[np.int64]:
        """Times of day that go on after midnight, minutes that go on after the hour."""
        state = self.state
        before = state.clock_ns.get(k, int(stamps[0]))
        wraps = np.diff(stamps, prepend=before % period) < -period // 2
        state.midnights += [numbers[i] for i in np.flatnonzero(wraps).tolist()]
        state.period_ns = period
        stamps = stamps + (before // period + np.cumsum(wraps)) * period
        state.clock_ns[k] = int(stamps[-1])
        return stamps

    def _lists(self, k: int, cells: Sequence[str]) -> Array | None:
        """Cells ``[0.1, 0.2]`` as one row of numbers each."""
        texts = [cell.strip() for cell in cells]
        if not all(text[:1] in ("[", "(") and text[-1:] in ("]", ")") for text in texts):
            return None
        parts = [text[1:-1].replace(";", ",").split(",") for text in texts]
        length = self.state.lengths.setdefault(k, len(parts[0]))
        if any(len(part) != length for part in parts):
            return None
        values = _cell.numbers([cell for part in parts for cell in part])
        return None if values is None else values.reshape(len(parts), length)

    def fault(self, line: int, k: int, cell: str, *, told: bool) -> str:
        """The fault of one cell, or of a whole line (``k`` is below 0)."""
        if k < 0:
            return f"line {line}: {cell}"
        layout, name = self.layout, self.layout.names[k][0]
        kind = layout.kinds[k]
        if kind == "number" and mark_of(cell) == "?" and layout.decimal == ".":
            return doubt(line, name, cell)
        expected = {
            "list": f"a list of {self.state.lengths.get(k, 0)} numbers",
            "flag": "true or false",
            "date": f"a date as {layout.styles[k].words}" if k in layout.styles else "a date",
            "integer": "a whole number",
        }.get(kind, "a number" + (" with a decimal comma" if layout.decimal == "," else ""))
        text = f"line {line}, column {name!r}: {cell.strip()[:60]!r} is not {expected}"
        is_word = kind == "number" and not re.search(r"\d", cell)
        if is_word and not told:  # mostly it says just that; told once
            text += "; where nothing was measured, leave the cell empty, or delete the line"
        return text

    def unclear_dates(self) -> Iterator[str]:
        """Faults of dates whose day may be their month, where that matters."""
        if len(self.state.days) > 1:
            for k, example in self.state.examples.items():
                style, name = self.layout.styles[k], self.layout.names[k][0]
                other = replace(style, order=style.other).words
                yield (
                    f"column {name!r}: {example!r} may be {style.words} or {other}, and the date"
                    " changes in the log; write dates as 2024-12-31"
                )
