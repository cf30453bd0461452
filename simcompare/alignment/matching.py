"""Events of a reference and of a log brought together in order of time."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simcompare.errors import InputError
from simcompare.model.trajectory import Array


@dataclass(frozen=True)
class Matching:
    """Which event of the log belongs to which event of the reference.

    Attributes:
        pairs: (index in the reference, index in the log), increasing in both.
        missed: events of the reference that the log does not have.
        extra: events of the log that the reference does not have.
        errors_s: time in the log minus time in the reference, one per pair [s].
        tolerance_s: greatest error of a pair [s].
    """

    pairs: tuple[tuple[int, int], ...]
    missed: tuple[int, ...]
    extra: tuple[int, ...]
    errors_s: Array
    tolerance_s: float


def match(reference_s: ArrayLike, log_s: ArrayLike, tolerance_s: float) -> Matching:
    """The best matching of two series of events that keeps their order.

    It has the least sum of absolute errors plus half the tolerance for every event without a
    partner (a global alignment by dynamic programming: S. B. Needleman and C. D. Wunsch, J. Mol.
    Biol. 48 (1970) 443-453), so a pair is never farther apart than the tolerance, and a series
    is not shifted by one event to save a single missing one.

    Args:
        reference_s: times of the reference's events, increasing [s].
        log_s: times of the log's events, increasing, on the same clock [s].
        tolerance_s: greatest error of a pair [s].

    Raises:
        InputError: a time is missing or out of order, or the tolerance is not positive.
    """
    reference, log = times_of(reference_s, "reference"), times_of(log_s, "log")
    if not tolerance_s > 0:
        raise InputError("matching", [f"the tolerance is {tolerance_s} s; it must be positive"])
    pairs: list[tuple[int, int]] = []
    for rows, columns in _clusters(reference, log, tolerance_s):
        matched = _best(reference[rows], log[columns], tolerance_s)
        pairs += [(rows.start + i, columns.start + j) for i, j in matched]
    ours, theirs = {i for i, _ in pairs}, {j for _, j in pairs}
    i, j = (np.array(side, dtype=int) for side in (zip(*pairs, strict=True) if pairs else ((), ())))
    return Matching(
        pairs=tuple(pairs),
        missed=tuple(k for k in range(len(reference)) if k not in ours),
        extra=tuple(k for k in range(len(log)) if k not in theirs),
        errors_s=log[j] - reference[i],
        tolerance_s=float(tolerance_s),
    )


def times_of(times_s: ArrayLike, which: str) -> Array:
    """Times of events as an array (n,), checked to be finite and in order [s].

    Args:
        times_s: the times [s].
        which: whose events they are, for the message.

    Raises:
        InputError: a time is missing or earlier than the one before.
    """
    times = np.atleast_1d(np.asarray(times_s, dtype=float)).ravel()
    bad = np.flatnonzero(~np.isfinite(times))
    if len(bad):
        raise InputError("events", [f"time {bad[0] + 1} of the {which} is {times[bad[0]]}"])
    back = np.flatnonzero(np.diff(times) < 0)
    if len(back):
        k = int(back[0])
        text = f"time {k + 2} of the {which} ({times[k + 1]:g} s) is before time {k + 1}; sort them"
        raise InputError("events", [text])
    return times


def _clusters(reference: Array, log: Array, tolerance_s: float) -> list[tuple[slice, slice]]:
    """Parts that cannot have pairs across their borders."""
    if not len(reference) or not len(log):
        return []
    times = np.concatenate((reference, log))
    order = np.argsort(times, kind="stable")
    cuts = np.flatnonzero(np.diff(times[order]) > tolerance_s) + 1
    ours = np.concatenate(([0], np.cumsum(order < len(reference))))
    edges = np.concatenate(([0], cuts, [len(times)]))
    clusters = []
    for low, high in pairwise(edges):
        rows = slice(int(ours[low]), int(ours[high]))
        columns = slice(int(low - ours[low]), int(high - ours[high]))
        if rows.start < rows.stop and columns.start < columns.stop:
            clusters.append((rows, columns))
    return clusters


def _best(reference: Array, log: Array, tolerance_s: float) -> list[tuple[int, int]]:
    """Pairs of one part; row by row, each row for all events of the log at once."""
    n, m, single = len(reference), len(log), tolerance_s / 2
    step = single * np.arange(m + 1)
    paired, from_left = np.zeros((n, m + 1), dtype=bool), np.zeros((n, m + 1), dtype=bool)
    cost = step.copy()
    for i in range(n):
        error = np.abs(log - reference[i])
        skipped = cost + single
        together = np.full(m + 1, np.inf)
        together[1:] = np.where(error <= tolerance_s, cost[:-1] + error, np.inf)
        paired[i] = together <= skipped
        row = np.minimum(together, skipped) - step
        best = np.minimum.accumulate(row)
        from_left[i] = best < row
        cost = best + step
    return _walk_back(paired, from_left)


def _walk_back(paired: NDArray[np.bool_], from_left: NDArray[np.bool_]) -> list[tuple[int, int]]:
    i, j = paired.shape[0] - 1, paired.shape[1] - 1
    pairs = []
    while i >= 0:
        if from_left[i, j]:
            j -= 1
        elif paired[i, j]:
            pairs.append((i, j - 1))
            i, j = i - 1, j - 1
        else:
            i -= 1
    return pairs[::-1]
