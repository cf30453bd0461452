"""Height against time cut into flights.

Adding g·t²/2 makes a flight a straight line and an impact a kink upwards; where the slope before
and after differs by more than noise, there is an impact.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_bounces import Rejected
from simcompare.statistics.agreement import MAD_TO_SD

#: samples that a flight must have
MIN_SAMPLES = 4
#: a kink is this many standard deviations of the slopes' difference
_KINK = 6.0
#: a ball that falls is faster than so many standard deviations of the slopes' difference
_FALLING = 3.0
#: slowest change of velocity that is looked for [m/s], and the longest window for it [s]
_SLOW, _LONG_S = 0.6, 0.1


def samples(
    time_s: ArrayLike, height_m: ArrayLike, u_m: ArrayLike | None, source: str
) -> tuple[Array, Array, Array, list[Rejected]]:
    """Times, heights and uncertainties of what was measured, and the samples that were not.

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
    faults = []
    if np.count_nonzero(whole) < 2 * MIN_SAMPLES:
        faults.append(f"{np.count_nonzero(whole)} samples of height; a bounce needs at least"
                      f" {2 * MIN_SAMPLES}")  # fmt: skip
    elif np.any(np.diff(time[whole]) <= 0):
        faults.append("the times of the heights do not increase")
    if np.any(u <= 0):
        faults.append("a standard uncertainty of a height is not above 0")
    if faults:
        raise InputError(source or "height", faults)
    return time[whole], height[whole], u[whole], gone


def noise_of(height: Array) -> float:
    """Standard deviation of one sample: third differences of a parabola are none."""
    third = np.diff(height, 3)
    return max(MAD_TO_SD * float(np.median(np.abs(third))) / math.sqrt(20), 1e-7)


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
            source or "height",
            ["the height turns downwards at the impacts: it is counted downwards; give it the other"
             " sign in a mapping file"],
        )  # fmt: skip
    tops = [
        i for i in np.flatnonzero(kink > threshold).tolist()
        if kink[i] == np.max(kink[max(0, i - width) : i + width + 1])
    ]  # fmt: skip
    if not tops:
        raise InputError(
            source or "height",
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


def long_enough(time: Array, flight: NDArray[np.intp], source: str) -> NDArray[np.int64]:
    """Flights up to the first one with too few samples; those after it are marked -1."""
    counts = np.bincount(flight)
    first = 0
    # a recording may begin in the last frames of a fall
    while first < len(counts) and counts[first] < MIN_SAMPLES:
        first += 1
    last = first
    while last < len(counts) and counts[last] >= MIN_SAMPLES:
        # a flight that lasts longer than the one before it hides an impact
        if last > first + 1 and counts[last] > 1.05 * counts[last - 1] + 1:
            break
        last += 1
    if last - first < 2:
        raise InputError(
            source or "height",
            [f"{last - first} flight has {MIN_SAMPLES} samples or more; two at least are needed,"
             " three for a restitution without a known drop height: film faster or drop from"
             " higher"],
        )  # fmt: skip
    inside = (flight >= first) & (flight < last)
    return np.where(inside, flight - first, -1)
