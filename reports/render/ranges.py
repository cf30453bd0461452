"""Ranges of an axis."""

from __future__ import annotations

from simcompare.model.trajectory import Array

#: a span below this part of the size is no variation, and values below the second are rounding
_NO_SPAN, _DUST = 1e-6, 1e-9


def calm_range(values: Array) -> tuple[float, float] | None:
    """A range in which rounding looks like nothing; ``None`` where the values really vary."""
    if len(values) == 0:
        return None
    low, high = float(values.min()), float(values.max())
    size = max(abs(low), abs(high))
    if size < _DUST:
        return -_NO_SPAN, _NO_SPAN
    if high - low >= _NO_SPAN * size:
        return None
    middle = (low + high) / 2
    return middle - 0.1 * size, middle + 0.1 * size
