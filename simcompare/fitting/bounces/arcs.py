"""Flights of a filmed ball joined to impact times.

A flight is fitted by a parabola, of which only the apex is unknown, and neighbouring parabolas are
intersected: neither the floor's level nor a frame at the impact is needed. With g·t²/2 added they
are straight lines. Air drag bends them, so they only show what was measured; the fit takes the
samples.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.flights import MIN_SAMPLES, noise_of, samples, start_of
from simcompare.fitting.bounces.following import follow
from simcompare.fitting.bounces.impacts import HEIGHT, TRACK, Impacts, Signal, Track
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_bounces import Rejected

#: part of the drop height by which a ball has moved before, and what is said then
_MOVED = 0.1
_BEFORE = (
    "the ball counts as dropped at {:.2f} s, but its height changes by {:.2g} m before: if it had"
    " bounced already, the drop height is that of a later bounce"
)


def from_heights(
    time_s: ArrayLike,
    height_m: ArrayLike,
    u_m: ArrayLike | None = None,
    *,
    gravity_m_s2: float = bounce_models.GRAVITY,
    source: str = "",
) -> Impacts:
    """One drop from height against time.

    Args:
        time_s: (n,) [s].
        height_m: above any level (n,), NaN where nothing was seen [m].
        u_m: standard uncertainty, one or one each; from the scatter where ``None`` [m].
        gravity_m_s2: free fall.
        source: name of the file.

    Raises:
        InputError: no impact, or flights with too few samples.
    """
    seen = samples(time_s, height_m, u_m, source)
    time, height, u = seen.time_s, seen.height_m, seen.u_m
    noise = float(np.median(u)) if np.isfinite(u).all() else noise_of(height)
    start = start_of(seen, noise, gravity_m_s2)
    flight, why = follow(seen, noise, gravity_m_s2, start)
    left_out = [
        Rejected("sample", int(seen.rows[k]) + 1, float(time[k]), why[k]) for k in sorted(why)
    ]
    dropped = tuple(sorted((*seen.gone, *left_out), key=lambda one: one.number))
    used = flight >= 0
    track = Track(time[used], height[used], u[used], flight[used])
    filmed = Impacts(
        kind=TRACK, source=source, track=track, dropped=dropped, signal=Signal(HEIGHT, time, height)
    )
    joined = _joined(filmed, track, gravity_m_s2)
    before = height[time < track.time_s[0]]
    if not len(before) or np.ptp(before) < _MOVED * joined.heights_m[0]:
        return joined
    return replace(joined, notes=(_BEFORE.format(track.time_s[0], float(np.ptp(before))),))


def _joined(impacts: Impacts, track: Track, gravity: float) -> Impacts:
    """The same with times at which neighbouring parabolas meet, and apexes above that level."""
    numbers = np.flatnonzero(np.bincount(track.flight) >= MIN_SAMPLES)
    variance, lines, spreads = _lines(track, numbers, gravity)
    spreads = variance * spreads
    before = np.flatnonzero(np.diff(numbers) == 1)
    after, (slope, at_0) = before + 1, lines.T
    turn = slope[after] - slope[before]
    join = (at_0[before] - at_0[after]) / turn
    # of a join to its two lines, each (slope, height at 0)
    change = np.zeros((len(before), len(numbers), 2))
    own = np.column_stack((join, np.ones(len(join)))) / turn[:, None]
    change[np.arange(len(before)), before], change[np.arange(len(before)), after] = own, -own
    covariance = np.einsum("jna,nab,knb->jk", change, spreads, change)
    level = np.median(at_0[before] + slope[before] * join - 0.5 * gravity * join**2)
    # of an apex to its line
    rise = np.column_stack((slope / gravity, np.ones(len(slope))))
    return replace(
        impacts, times_s=track.time_s[0] + join, u_s=np.sqrt(np.diag(covariance)),
        covariance_s2=covariance, numbers=tuple((numbers[before] + 1).tolist()),
        heights_m=at_0 + slope**2 / (2 * gravity) - float(level),
        u_heights_m=np.sqrt(np.einsum("na,nab,nb->n", rise, spreads, rise)),
        height_numbers=tuple(numbers.tolist()),
    )  # fmt: skip


def _lines(track: Track, numbers: NDArray[np.intp], gravity: float) -> tuple[float, Array, Array]:
    """Variance for a weight of 1, slope and height at the first sample's time, and their spreads.

    Where no uncertainty is stated the variance is the scatter about the lines.
    """
    t = track.time_s - track.time_s[0]
    straight = track.height_m + 0.5 * gravity * t**2
    known = bool(np.isfinite(track.u_m).all())
    weight = 1 / track.u_m if known else np.ones(len(t))
    lines, spreads, squares = [], [], 0.0
    for number in numbers.tolist():
        own = track.flight == number
        line, spread = np.polyfit(t[own], straight[own], 1, w=weight[own], cov="unscaled")
        squares += float(np.sum((straight[own] - np.polyval(line, t[own])) ** 2))
        lines.append(line)
        spreads.append(spread)
    count = int(np.count_nonzero(np.isin(track.flight, numbers)))
    variance = 1.0 if known else squares / max(count - 2 * len(numbers), 1)
    return variance, np.array(lines), np.array(spreads)
