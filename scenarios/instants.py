"""Instants of references: where signals bend, times between samples, and changes of sign."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from simcompare.model.signals import Ramp, Signal, SineSteps, Step, Table
from simcompare.model.trajectory import Array

#: times that are closer than this are one [s]
CLOSE_S = 1e-11


def corners_of(signal: Signal) -> Array:
    """Times at which a signal jumps or bends [s]."""
    if isinstance(signal, Table):
        return np.array(signal.time_s)
    if isinstance(signal, Step):
        return np.array([signal.time_s])
    if isinstance(signal, Ramp):
        return np.array([signal.start_s, signal.end_s])
    if isinstance(signal, SineSteps):
        ends = signal.dwell_s * np.arange(1, len(signal.frequencies_Hz) + 1)
        return np.asarray(ends, dtype=float)
    return np.empty(0)


def grid(
    time_s: Array, corners_s: Array, longest_s: float, close_s: float = CLOSE_S
) -> tuple[Array, NDArray[np.intp]]:
    """Times from 0 on that hold samples and corners, and where among them the samples are.

    Args:
        time_s: samples (n,), increasing from 0 or later [s].
        corners_s: times at which what drives is not smooth, in any order [s].
        longest_s: longest piece between two of the times [s].
        close_s: two that are not farther apart than this are one [s].
    """
    inside = corners_s[(corners_s > 0) & (corners_s < time_s[-1])]
    edges = np.unique(np.concatenate((np.zeros(1), time_s, inside)))
    edges = edges[np.concatenate(([True], np.diff(edges) > close_s))]
    lengths = np.diff(edges)
    parts = np.maximum(np.ceil(lengths / longest_s), 1).astype(int)
    starts, widths = np.repeat(edges[:-1], parts), np.repeat(lengths / parts, parts)
    number = np.arange(len(starts)) - np.repeat(np.cumsum(parts) - parts, parts)
    times = np.append(starts + number * widths, edges[-1])
    return times, np.searchsorted(times, time_s - close_s)


def piece_at(starts_s: Array, time_s: Array) -> NDArray[np.intp]:
    """Which piece of time each sample is in, from the starts of all pieces."""
    return np.clip(np.searchsorted(starts_s, time_s, side="right") - 1, 0, len(starts_s) - 1)


def crossing(value: Callable[[float], float], low: float, high: float, halvings: int) -> float:
    """Where a function that is positive at first and negative at the end crosses 0."""
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        if value(middle) > 0:
            low = middle
        else:
            high = middle
    return high
