"""Errors of states in the units in which they read well."""

from __future__ import annotations

import math
from collections.abc import Iterable

from simcompare import units
from simcompare.reports.render import numbers

#: SI unit -> a thousand times smaller one, where people use that
_SMALLER = {"m": "mm", "m/s": "mm/s", "rad": "mrad", "rad/s": "mrad/s", "m/s**2": "mm/s²"}
#: sizes below this are read in the smaller unit
_SMALL = 0.1


def scale(state: str, sizes: Iterable[float | None]) -> tuple[float, str]:
    """Factor and unit in which errors of a state are written."""
    unit = units.unit_of(state)
    known = [abs(one) for one in sizes if one is not None and math.isfinite(one)]
    if unit in _SMALLER and known and min(known) < _SMALL:
        return 1e3, _SMALLER[unit]
    return 1.0, units.symbol(unit)


def text(value: float | None, factor: float) -> str:
    """A size in two digits, or as many as stand before its point."""
    if value is None:
        return "–"
    size = factor * value
    return numbers.plain(size, max(2, len(str(int(abs(size))))))
