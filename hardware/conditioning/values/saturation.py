"""Samples at which a sensor was at the end of its range: marked, never changed."""

from __future__ import annotations

import numpy as np

from simcompare.hardware.conditioning.clock import intervals
from simcompare.hardware.conditioning.clock.intervals import Indices, Mask
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import RawColumn

#: so many samples in a row at one end; a single one may be the true peak
_MIN_RUN = 3
#: largest numbers of converters from 10 bits on (fewer bits are also the ends of commands)
_FULL = frozenset(
    [2.0**bits - 1 for bits in (10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 23, 24, 31)]
    + [-(2.0**bits) for bits in (9, 11, 13, 15, 17, 19, 23, 31)]
)
#: a channel varies from sample to sample if its bends are larger than this, in smallest steps
_LIVELY = 4.0
#: flat stretches elsewhere, against those at the end, from which on they are natural
_ELSEWHERE = 0.1
#: a true peak is steeper than a parabola would be by no more than this
_STEEP = 2.0


def check(work: Work) -> None:
    """Marks saturated samples in ``work.saturated``."""
    for column in work.data:
        if column.name == work.stream.counter:
            continue
        low, high = intervals.extent(column.values)
        if not low < high:
            continue  # a constant channel says nothing
        if column.limits is not None:
            _at_limits(work, column)
        else:
            _flat_ends(work, column, low, high)


def _at_limits(work: Work, column: RawColumn) -> None:
    lowest, highest = sorted(column.limits or (-np.inf, np.inf))
    margin = 1e-9 * max(abs(lowest), abs(highest))
    at_end = (column.values >= highest - margin) | (column.values <= lowest + margin)
    where = f"at the end of the sensor's range ({lowest:g} to {highest:g})"
    _mark(work, column, *_long_runs(at_end), where)


def _flat_ends(work: Work, column: RawColumn, low: float, high: float) -> None:
    """Flat stretches at the very extremes, cut off as no true peak is."""
    ends = [_long_runs(column.values == end) for end in (low, high)]
    if not any(len(first) for first, _ in ends):
        return
    smallest = intervals.resolution(column.values)
    lively = _bends(column) >= _LIVELY * smallest
    at_ends = sum(len(first) for first, _ in ends)
    natural = _flat_elsewhere(column, low, high) > _ELSEWHERE * at_ends
    counts = intervals.whole_numbers(column)
    runs: list[tuple[Indices, Indices]] = []
    ends_used: list[float] = []
    for end, (first, length) in zip((low, high), ends, strict=True):
        full = counts and end in _FULL
        if not len(first) or not (full or (lively and not natural)):
            continue
        # one that is cut off for certain shows where the range ends
        if _cut_off(column, end, first, length, smallest):
            runs.append((first, length))
            ends_used.append(end)
    if not runs:
        return
    first = np.concatenate([first for first, _ in runs])
    length = np.concatenate([length for _, length in runs])
    order = np.argsort(first)
    which = " and ".join(f"{end:g}" for end in ends_used)
    _mark(
        work, column, first[order], length[order],
        f"at the very extreme ({which}) and flat, cut off as a sensor does at the end of its range",
    )  # fmt: skip


def _long_runs(at_end: Mask) -> tuple[Indices, Indices]:
    """First sample and length of the runs of at least three samples at an end."""
    first, length = intervals.runs(at_end)
    long = length >= _MIN_RUN
    return first[long], length[long]


def _bends(column: RawColumn) -> float:
    """Usual size of the second difference of the values."""
    bends = [
        np.abs(np.diff(column.values[part], 2)) for part in intervals.places(len(column.values))
    ]
    together = np.concatenate(bends)
    together = together[np.isfinite(together)]
    return float(np.median(together)) if len(together) else 0.0


def _flat_elsewhere(column: RawColumn, low: float, high: float) -> int:
    """How many flat stretches there are that are not at the extremes."""
    total = 0
    for part in intervals.places(len(column.values)):
        values = np.asarray(column.values[part])
        flat: Mask = (values[1:] == values[:-1]) & (values[1:] != low) & (values[1:] != high)
        _, length = intervals.runs(flat)
        total += int((length >= _MIN_RUN - 1).sum())
    return total


def _cut_off(
    column: RawColumn, end: float, first: Indices, length: Indices, smallest: float
) -> bool:
    """Whether a stretch ends, on both sides, too steeply for a peak that rounding makes flat."""
    values = column.values
    inside = (first >= 2) & (first + length + 2 <= len(values))
    first, length = first[inside], length[inside]
    # a parabola that is flat to one step over the stretch has fallen by no more than this two on
    bound = _STEEP * 4 * smallest * ((length + 3) / (2 * (length - 1))) ** 2
    sides = np.abs(np.stack([values[first - 2], values[first + length + 1]]) - end)
    return bool((sides >= bound).all(axis=0).any())


def _mark(work: Work, column: RawColumn, first: Indices, length: Indices, where: str) -> None:
    if not len(first):
        return
    samples = intervals.spread(first, length)
    mask = np.zeros(len(column.values), dtype=np.bool_)
    mask[samples] = True
    work.saturated[column.name] = mask
    runs = "one stretch" if len(first) == 1 else f"{len(first)} stretches"
    work.warn(
        "saturation",
        f"{len(samples)} samples in {runs} stand {where}; they are marked, and their true"
        " values are not known",
        samples=samples,
        channel=column.name,
        after={"samples": float(len(samples)), "longest": float(length.max())},
    )
