"""Height against time cut into flights.

Adding g·t²/2 makes a flight a straight line and an impact a kink upwards; where the slope before
and after differs by more than noise, there is an impact.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simcompare.errors import InputError
from simcompare.fitting.bounces.lines import shared
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_bounces import Rejected

#: samples that tell an arc and whether they lie on it
MIN_SAMPLES = 4
#: a sample so many standard deviations off the flight of its neighbours is none of it
OUTLIER = 6.0
#: part of its samples that a flight has on one arc
MOST = 0.6
#: a quarter of normal errors is below this, in standard deviations
_QUARTER = 0.3186
#: a kink is this many standard deviations of the slopes' difference
_KINK = 6.0
#: a ball that falls is faster than so many standard deviations of the slopes' difference
_FALLING = 3.0
#: slowest change of velocity that is looked for [m/s], and the longest window for it [s]
_SLOW, _LONG_S = 0.6, 0.1


@dataclass(frozen=True)
class Samples:
    """What was measured of the heights, and the samples that were not.

    Attributes:
        time_s: (n,) [s].
        height_m: (n,) [m].
        u_m: standard uncertainty, NaN where unknown (n,) [m].
        rows: place of each among all that were recorded, first is 0 (n,).
        gone: samples in which nothing was seen.
        source: name of the file.
    """

    time_s: Array
    height_m: Array
    u_m: Array
    rows: NDArray[np.intp]
    gone: list[Rejected]
    source: str


def samples(time_s: ArrayLike, height_m: ArrayLike, u_m: ArrayLike | None, source: str) -> Samples:
    """Times, heights and uncertainties of what was measured.

    Raises:
        InputError: too few samples, times out of order, or an uncertainty that is none.
    """
    time, height = np.asarray(time_s, dtype=float), np.asarray(height_m, dtype=float)
    u = np.full(len(time), np.nan)
    if u_m is not None:
        u[:] = u_m
    whole = np.isfinite(time) & np.isfinite(height)
    gone = [Rejected("sample", int(k) + 1, float(time[k]), "nothing seen")
            for k in np.flatnonzero(~whole)]  # fmt: skip
    faults, source = [], source or "height"
    if np.count_nonzero(whole) < 2 * MIN_SAMPLES:
        faults.append(f"{np.count_nonzero(whole)} samples of height; a bounce needs at least"
                      f" {2 * MIN_SAMPLES}")  # fmt: skip
    elif np.any(np.diff(time[whole]) <= 0):
        faults.append("the times of the heights do not increase")
    if np.any(u <= 0):
        faults.append("a standard uncertainty of a height is not above 0")
    if faults:
        raise InputError(source, faults)
    return Samples(time[whole], height[whole], u[whole], np.flatnonzero(whole), gone, source)


def noise_of(height: Array) -> float:
    """Standard deviation of one sample: third differences of a parabola are none.

    Those over an impact are large, so the lower ones tell.
    """
    third = np.abs(np.diff(height, 3))
    return max(float(np.quantile(third, 0.25)) / _QUARTER / math.sqrt(20), 1e-7)


def kinks(
    time: Array, height: Array, noise: float, gravity: float, source: str
) -> NDArray[np.intp]:
    """Index of the first sample after each impact."""
    step = float(np.median(np.diff(time)))
    width = 2
    while _KINK * _u_of_kink(noise, step, width) > _SLOW and width * step < _LONG_S:
        width += 1
    straight = height + 0.5 * gravity * (time - time[0]) ** 2
    slopes = _slopes(time, straight, width)
    # slope of the window that begins at i, less that of the window that ends at i - 1
    kink = np.full(len(time), -np.inf)
    kink[width : len(time) - width + 1] = slopes[width:] - slopes[: len(slopes) - width]
    before = np.zeros(len(time))
    before[width : len(time) - width + 1] = _slopes(time, height, width)[: len(slopes) - width]
    # in a hand and at rest a ball does not fall: there the straight line bends by g all the time
    u_kink = _u_of_kink(noise, step, width)
    threshold = max(_KINK * u_kink, 1.3 * gravity * width * step)
    kink[before > -_FALLING * u_kink] = -np.inf
    down = -float(np.min(kink[np.isfinite(kink)], initial=0.0))
    if down > 2 * max(float(np.max(kink)), _SLOW):
        raise InputError(
            source,
            ["the height turns downwards at the impacts: it is counted downwards; give it the other"
             " sign in a mapping file"],
        )  # fmt: skip
    tops = [
        i for i in np.flatnonzero(kink > threshold).tolist()
        if kink[i] == np.max(kink[max(0, i - width) : i + width + 1])
    ]  # fmt: skip
    if not tops:
        raise InputError(
            source,
            [f"no impact is seen: nowhere does the velocity change upwards by more than"
             f" {threshold:.2g} m/s within {2 * width * step:.2g} s; is it the height of a"
             " bouncing ball, in metres?"],
        )  # fmt: skip
    return np.array(tops, dtype=np.intp)


def _u_of_kink(noise: float, step: float, width: int) -> float:
    """Standard deviation of the difference of two slopes through so many samples."""
    return float(np.sqrt(2) * noise / (step * np.sqrt(width * (width**2 - 1) / 12)))


def _slopes(time: Array, values: Array, width: int) -> Array:
    """Least-squares slope of every window of so many samples, by its first sample."""
    windows = np.lib.stride_tricks.sliding_window_view
    t, y = windows(time, width), windows(values, width)
    t = t - t.mean(axis=1, keepdims=True)
    return np.asarray(np.sum(t * y, axis=1) / np.sum(t * t, axis=1))


def no_flights(source: str) -> InputError:
    """What is said where nothing bounces that can be followed."""
    return InputError(
        source,
        [f"no two flights after each other have {MIN_SAMPLES} samples each on two arcs that meet at"
         " a floor: film faster or drop from higher"],
    )  # fmt: skip


def start_of(seen: Samples, noise: float, gravity: float) -> Mapping[str, float]:
    """The motion as two flights after each other tell it, without drag; the first is its drop.

    Raises:
        InputError: no two flights that follow each other.
    """
    steady = ~_spikes(seen.time_s, seen.height_m, noise, gravity)
    t, y = seen.time_s[steady], seen.height_m[steady]
    cuts = kinks(t, y, noise, gravity, seen.source)
    ends = [*t[cuts].tolist(), math.inf]
    flight = np.searchsorted(cuts, np.arange(len(t)), side="right")
    # before it falls a ball is in a hand
    longest = 1.1 * math.sqrt(2 * float(np.ptp(y)) / gravity)
    apexes = [
        _apex(t, y, np.flatnonzero((flight == n) & (t > end - longest)), noise, gravity)
        for n, end in enumerate(ends[:-1])
    ] + [_apex(t, y, np.flatnonzero(flight == len(cuts)), noise, gravity)]
    pairs = [_joined(one, two, gravity) for one, two in itertools.pairwise(apexes)]
    found = [pair for pair in pairs if pair is not None]
    if not found:
        raise no_flights(seen.source)
    return max(found, key=lambda pair: pair[0])[1]


def _spikes(time: Array, height: Array, noise: float, gravity: float) -> NDArray[np.bool_]:
    """Samples on the line neither of the two before nor of the two after, free fall taken off."""
    straight = height + 0.5 * gravity * (time - time[0]) ** 2
    off = np.full((2, len(time)), True)
    for row, side in zip(off, (-1, 1), strict=True):
        t, y = time[::side], straight[::side]
        ahead = (t[2:] - t[1:-1]) / (t[1:-1] - t[:-2])
        foretold = y[1:-1] + (y[1:-1] - y[:-2]) * ahead
        u = noise * np.sqrt(1 + (1 + ahead) ** 2 + ahead**2)
        row[::side][2:] = np.abs(y[2:] - foretold) > OUTLIER * u
    off[0, :2], off[1, -2:] = off[1, :2], off[0, -2:]
    return np.asarray(off[0] & off[1])


@dataclass(frozen=True)
class _Apex:
    """Apex of the parabola that most of a flight's samples share, and how many these are."""

    time_s: float
    height_m: float
    count: int


def _apex(
    time: Array, height: Array, own: NDArray[np.intp], noise: float, gravity: float
) -> _Apex | None:
    if len(own) < MIN_SAMPLES:
        return None
    t, y = time[own], height[own]
    # drag bends a fall by about a hundredth of its height
    near = max(OUTLIER * noise, 0.01 * float(np.ptp(y)))
    middle = float(t.mean())
    line = shared(own, t, y + 0.5 * gravity * (t - middle) ** 2, near)
    count = int(np.count_nonzero(line.on))
    if count < MOST * len(own):
        return None
    apex = middle + line.slope / gravity
    top = line.level + line.slope * (apex - line.middle) - 0.5 * gravity * (apex - middle) ** 2
    return _Apex(apex, top, count)


def _joined(
    one: _Apex | None, two: _Apex | None, gravity: float
) -> tuple[int, dict[str, float]] | None:
    """Samples on two flights, and their motion; nothing where they are none of a bouncing ball."""
    if one is None or two is None or not two.time_s > one.time_s:
        return None
    a, b, high, low = one.time_s, two.time_s, one.height_m, two.height_m
    impact = (a + b) / 2 + (high - low) / (gravity * (b - a))
    floor = high - 0.5 * gravity * (impact - a) ** 2
    if not (a < impact < b and floor < low < 1.1 * (high - floor) + floor):
        return None
    values = {
        "restitution": min(math.sqrt((low - floor) / (high - floor)), 0.98),
        "drop_height_m": high - floor, "release_time_s": a, "floor_m": floor, "scale": 1.0,
    }  # fmt: skip
    return one.count + two.count, values
