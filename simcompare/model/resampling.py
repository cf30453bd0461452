"""Simulation and measurement brought to the same instants and the same bandwidth."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simcompare.errors import InputError
from simcompare.model.trajectory import Array

Flags = NDArray[np.bool_]


def interpolated(
    time_s: ArrayLike,
    values: ArrayLike,
    at_s: ArrayLike,
    *,
    rates: ArrayLike | None = None,
    events_s: ArrayLike = (),
    gap_s: float = math.inf,
) -> Array:
    """A simulated signal at the instants of a measurement, never across an event.

    Between two samples the signal is a cubic Hermite polynomial, with the rates of change given or
    taken from three neighbouring samples on the same side of every event. Instants within one
    sample of the measurement on either side of an event are left out (NaN): there a smooth
    comparison means nothing, and event times are compared instead.

    Args:
        time_s: times of the simulation (n,), increasing [s].
        values: the signal (n,); NaN where it has none.
        at_s: instants of the measurement (m,), increasing [s].
        rates: rate of change of the signal at its samples (n,) [1/s].
        events_s: times of impacts and other jumps [s].
        gap_s: longest interval of the simulation that is bridged [s].

    Returns:
        The signal at the instants (m,), NaN outside of the simulation, in gaps and at events.

    Raises:
        InputError: lengths differ, or the times of the simulation do not increase.
    """
    t, y = np.asarray(time_s, dtype=float), np.asarray(values, dtype=float)
    at = np.asarray(at_s, dtype=float)
    slope = None if rates is None else np.asarray(rates, dtype=float)
    _check(t, y, slope)
    events = np.sort(np.asarray(events_s, dtype=float).ravel())
    known = np.isfinite(t) & np.isfinite(y)
    if slope is not None:
        known &= np.isfinite(slope)
    t, y = t[known], y[known]
    signal = np.full(at.shape, np.nan)
    if len(t) < 2:
        return signal
    arc = np.searchsorted(events, t, side="right")
    v = _rates(t, y, arc) if slope is None else slope[known]
    inside = np.isfinite(at) & (at >= t[0]) & (at <= t[-1])
    k = np.clip(np.searchsorted(t, at[inside], side="right") - 1, 0, len(t) - 2)
    piece = _hermite(t, y, v, k, at[inside])
    across = (arc[k] != arc[k + 1]) | (t[k + 1] - t[k] > gap_s)
    # an instant that is a sample needs no neighbour
    exact = (at[inside] == t[k]) | (at[inside] == t[k + 1])
    piece[across & ~exact] = np.nan
    signal[inside] = piece
    signal[near_events(at, events)] = np.nan
    return signal


def _check(t: Array, y: Array, slope: Array | None) -> None:
    bad = []
    if t.shape != y.shape:
        bad.append(f"{len(t)} times and {len(y)} values; give one value per time")
    if slope is not None and slope.shape != t.shape:
        bad.append(f"{len(t)} times and {len(slope)} rates; give one rate per time")
    if not np.all(np.diff(t) > 0):
        k = int(np.argmin(np.diff(t)))
        bad.append(f"time {t[k + 1]:g} s does not come after {t[k]:g} s; expected increasing times")
    if bad:
        raise InputError("interpolation", bad)


def _rates(t: Array, y: Array, arc: NDArray[np.integer]) -> Array:
    """Rates of change from parabolas through three samples, one-sided at the ends of an arc."""
    secant, step = np.diff(y) / np.diff(t), np.diff(t)
    same = arc[1:] == arc[:-1]
    left = np.concatenate(([False], same))
    right = np.concatenate((same, [False]))
    before = np.concatenate(([0.0], np.where(same, secant, 0.0)))
    after = np.concatenate((np.where(same, secant, 0.0), [0.0]))
    h0, h1 = np.concatenate(([1.0], step)), np.concatenate((step, [1.0]))
    rates = np.where(left & right, (h1 * before + h0 * after) / (h0 + h1), before + after)
    return np.asarray(_ends(t, secant, same, left, right, rates))


def _ends(t: Array, secant: Array, same: Flags, left: Flags, right: Flags, rates: Array) -> Array:
    """At the ends of an arc the parabola through the three nearest samples, where there are."""
    step = np.diff(t)
    first = np.flatnonzero(right & ~left)
    first = first[first + 1 < len(same)]
    first = first[same[first + 1]]
    bend = (secant[first + 1] - secant[first]) / (step[first] + step[first + 1])
    rates[first] = secant[first] - bend * step[first]
    last = np.flatnonzero(left & ~right)
    last = last[last >= 2]
    last = last[same[last - 2]]
    bend = (secant[last - 1] - secant[last - 2]) / (step[last - 1] + step[last - 2])
    rates[last] = secant[last - 1] + bend * step[last - 1]
    return rates


def _hermite(t: Array, y: Array, v: Array, k: NDArray[np.intp], at: Array) -> Array:
    step = t[k + 1] - t[k]
    s = (at - t[k]) / step
    rise = y[k + 1] - y[k]
    return np.asarray(
        y[k] + rise * s**2 * (3 - 2 * s) + step * s * (1 - s) * (v[k] * (1 - s) - v[k + 1] * s)
    )


def near_events(at_s: ArrayLike, events_s: ArrayLike) -> Flags:
    """Which instants are the last one before an event, or the first one after (or at) it.

    Args:
        at_s: instants (m,), increasing [s].
        events_s: times of the events [s].
    """
    at, events = np.asarray(at_s, dtype=float), np.asarray(events_s, dtype=float).ravel()
    hit = np.zeros(at.shape, dtype=bool)
    if not len(at):
        return hit
    for event in events[(events >= at[0]) & (events <= at[-1])]:
        k = int(np.searchsorted(at, event, side="left"))
        hit[max(0, k - 1) : k + 1] = True
        if at[k] == event:
            hit[k : k + 2] = True
    return hit
