"""What the checks of the clock share: steps between stamps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import RawColumn
from simcompare.model.trajectory import Array

Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]

#: samples on which medians are based; a longer column is looked at in places spread over it
SAMPLED = 1 << 20
_PLACES = 64
#: fewer steps are multiples of something by chance
_MIN_STEPS = 20


def places(count: int) -> list[slice]:
    """Stretches of a column on which its statistics are based: all of it where it is short."""
    if count <= SAMPLED:
        return [slice(0, count)]
    width = SAMPLED // _PLACES
    starts = np.linspace(0, count - width, _PLACES).astype(int)
    return [slice(int(start), int(start) + width) for start in starts]


def sampled_steps(values: Array) -> Array:
    """Differences of neighbours, of the whole column or of places spread over it."""
    return np.concatenate([np.diff(values[part]) for part in places(len(values))])


def where(values: Array, test: Callable[[Array], Mask]) -> Indices:
    """Indices i at which the step from i to i+1 passes a test."""
    return np.flatnonzero(test(np.diff(values)))


def typical(time_s: Array) -> float:
    """Median of the steps forward, 0 where there is none."""
    step = sampled_steps(time_s)
    forward = step[step > 0]
    return float(np.median(forward)) if len(forward) else 0.0


def runs(mask: Mask) -> tuple[Indices, Indices]:
    """Where a mask is set: first index and length of each stretch."""
    # whether each sample differs from the one before; no copy is wider than the mask
    turns = np.flatnonzero(mask[1:] != mask[:-1]) + 1
    if len(mask) and mask[0]:
        turns = np.concatenate(([0], turns))
    if len(mask) and mask[-1]:
        turns = np.concatenate((turns, [len(mask)]))
    return turns[::2], turns[1::2] - turns[::2]


def spread(first: Indices, length: Indices) -> Indices:
    """All indices of stretches that are given by their first index and length."""
    if not len(first):
        return np.empty(0, dtype=np.int64)
    ends = np.cumsum(length)
    return np.arange(ends[-1]) - np.repeat(ends - length, length) + np.repeat(first, length)


def float_step(work: Work) -> float:
    """Smallest step that the stamps of a log can show as floating-point numbers [s]."""
    last = float(work.time_s[-1]) if len(work.time_s) else 0.0
    largest = max(abs(work.start_s), abs(last) if np.isfinite(last) else 0.0)
    return float(np.spacing(largest))


def quantum(work: Work) -> float:
    """Smallest step of the stamps [s] of which all others are multiples, 0 where none is seen.

    Stamps that are all equally far apart show none: that step may be the true one.
    """
    noise = 4 * float_step(work)
    step = sampled_steps(work.time_s)
    step = np.sort(np.abs(step[np.isfinite(step)]))
    apart = np.diff(step)
    apart = apart[apart > 2 * noise]
    forward = step[step > noise]
    if not len(apart) or len(forward) < _MIN_STEPS:
        return 0.0
    quantum_s = float(min(apart.min(), forward[0]))
    middle = float(np.median(forward))
    if quantum_s < 1e-5 * middle:
        return 0.0  # so fine that it does not matter
    # the first guess is as wrong as the numbers are rounded; longer steps make it better
    for most in (30.0, 1000.0, np.inf):
        few = forward[forward <= most * quantum_s]
        times = np.round(few / quantum_s)
        if len(few) and times.sum():
            quantum_s = float(few.sum() / times.sum())
    off = np.abs(forward / quantum_s - np.round(forward / quantum_s))
    return quantum_s if np.quantile(off, 0.999) <= 0.1 else 0.0


def same(a: Array, b: Array) -> Mask:
    """Where two arrays are equal, missing values included."""
    equal: Mask = (a == b) | (np.isnan(a) & np.isnan(b))
    return equal


def extent(values: Array) -> tuple[float, float]:
    """Smallest and largest value that is there; infinities of the other sign where none is."""
    finite = values[np.isfinite(values)]
    return float(finite.min(initial=np.inf)), float(finite.max(initial=-np.inf))


def resolution(values: Array) -> float:
    """Smallest difference between neighbours that are not equal, 0 where all are."""
    apart = np.abs(np.diff(values))
    apart = apart[(apart > 0) & np.isfinite(apart)]
    return float(apart.min()) if len(apart) else 0.0


def shorten(indices: Indices, work: Work, most: int = 5) -> str:
    """Some rows in words: ``lines 5, 8, 9 and 12 more``."""
    rows = ", ".join(str(work.row(int(index))) for index in indices[:most])
    more = f" and {len(indices) - most} more" if len(indices) > most else ""
    plural = "s" if len(indices) > 1 else ""
    return f"{work.stream.row_word}{plural} {rows}{more}"


def whole_numbers(column: RawColumn) -> bool:
    """Whether a column holds whole numbers only (and at least one)."""
    finite = column.values[np.isfinite(column.values)]
    return len(finite) > 0 and np.array_equal(finite, np.rint(finite))
