"""Flight arcs between impacts, rebuilt from positions only.

Engines store velocities half a step away from positions, so speeds and apexes are never taken from
stored velocities. Positions of a semi-implicit engine lie exactly on a parabola in free flight; a
cubic through a short window describes that, and flight with air drag to well below a micrometre.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.model.trajectory import Array

#: samples of a flight that are needed to speak of one
MIN_SAMPLES = 12
#: samples in the window of one fit
WINDOW = 40
_DEGREE = 3


@dataclass(frozen=True)
class Arc:
    """One flight.

    Attributes:
        start_s: time at which its extension downwards leaves the floor [s].
        start_speed_m_s: upward speed there [m/s].
        end_s: time at which its extension reaches the floor [s]; infinite if the record ends first.
        end_speed_m_s: downward speed there [m/s], positive; NaN if the record ends first.
        apex_s: time of the highest point [s]; NaN if the record ends before it.
        apex_m: height of the highest point [m]; NaN if the record ends before it.
    """

    start_s: float
    start_speed_m_s: float
    end_s: float
    end_speed_m_s: float
    apex_s: float
    apex_m: float


@functools.lru_cache(maxsize=64)
def _projector(count: int) -> Array:
    """Matrix (4, n) from n even samples to cubic coefficients over the interval -1 … 1."""
    u = np.linspace(-1.0, 1.0, count)
    return np.asarray(np.linalg.pinv(np.vander(u, _DEGREE + 1, increasing=True)))


@dataclass(frozen=True)
class _Cubic:
    """Cubic in u = (t - centre)/half over a window of samples."""

    coefficients: tuple[float, float, float, float]
    centre_s: float
    half_s: float

    @classmethod
    def through(cls, time_s: Array, height_m: Array, first: int, last: int) -> _Cubic:
        count = last - first + 1
        a, b, c, d = (_projector(count) @ height_m[first : last + 1]).tolist()
        begin, end = float(time_s[first]), float(time_s[last])
        return cls((a, b, c, d), (begin + end) / 2, (end - begin) / 2)

    def root(self, near_s: float) -> tuple[float, float]:
        """Time near ``near_s`` at which the height is zero, and the velocity there."""
        a, b, c, d = self.coefficients
        u, slope = _newton(
            (near_s - self.centre_s) / self.half_s,
            lambda u: (a + u * (b + u * (c + u * d)), b + u * (2 * c + u * 3 * d)),
        )
        return self.centre_s + u * self.half_s, slope / self.half_s

    def top(self) -> tuple[float, float]:
        """Time and height of the maximum."""
        a, b, c, d = self.coefficients
        u, _ = _newton(0.0, lambda u: (b + u * (2 * c + u * 3 * d), 2 * c + 6 * d * u))
        return self.centre_s + u * self.half_s, a + u * (b + u * (c + u * d))


def _newton(u: float, function: Callable[[float], tuple[float, float]]) -> tuple[float, float]:
    """The root near ``u`` of a function that gives its value and slope, and its slope there."""
    slope = 1.0
    for _ in range(20):
        value, slope = function(u)
        if slope == 0:
            break
        change = value / slope
        u -= change
        if abs(change) < 1e-14:
            break
    return u, slope


def find(time_s: Array, height_m: Array) -> list[Arc]:
    """All flights from the start until one is too short to be resolved.

    Args:
        time_s: even sample times (n,) [s].
        height_m: height above the floor (n,) [m].

    Returns:
        The flights in order; the first one may begin in mid-air.

    Raises:
        InputError: the samples are not evenly spaced.
    """
    steps = np.diff(time_s)
    if len(steps) and np.ptp(steps) > 1e-6 * steps.mean():
        raise InputError(
            "arcs", [f"samples are {steps.min():g} to {steps.max():g} s apart; expected even"]
        )
    arcs = []
    lows = _local_minima(height_m)
    # movement below a millionth of the drop is rest, also when it is rest above the floor
    min_rise = 1e-6 * float(np.ptp(height_m))
    # an impact just before the record ends leaves no minimum, but a sample of the next flight
    for begin, end in zip([-2, *lows], [*lows, len(height_m)], strict=True):
        first, last = max(begin + 2, 0), end - 2
        above = np.flatnonzero(height_m[first : last + 1] > 0)
        if len(above) < MIN_SAMPLES:
            break
        first, last = first + int(above[0]), first + int(above[-1])
        if np.ptp(height_m[first : last + 1]) <= min_rise:
            break
        landed = end < len(height_m)  # else it is still in the air when the record ends
        arcs.append(_arc(time_s, height_m, first, last, landed=landed))
    return arcs


def _local_minima(height_m: Array) -> list[int]:
    inner = height_m[1:-1]
    low = (inner < height_m[:-2]) & (inner <= height_m[2:])
    return [int(k) + 1 for k in np.flatnonzero(low)]


def _arc(time_s: Array, height_m: Array, first: int, last: int, *, landed: bool) -> Arc:
    head = _Cubic.through(time_s, height_m, first, min(first + WINDOW - 1, last))
    tail = _Cubic.through(time_s, height_m, max(last - WINDOW + 1, first), last)
    highest = first + int(np.argmax(height_m[first : last + 1]))
    low, high = max(highest - WINDOW // 2, first), min(highest + WINDOW // 2, last)
    if high - low + 1 < MIN_SAMPLES:
        low, high = first, last
    start_s, start_speed = head.root(float(time_s[first]))
    end_s, end_speed = tail.root(float(time_s[last])) if landed else (math.inf, math.nan)
    if highest == last and not landed:  # the record ends while it rises
        apex_s = apex_m = math.nan
    elif highest == first:  # released, not thrown: the highest point is the first sample
        apex_s, apex_m = float(time_s[first]), float(height_m[first])
    else:
        apex_s, apex_m = _Cubic.through(time_s, height_m, low, high).top()
    return Arc(start_s, start_speed, end_s, -end_speed, apex_s, apex_m)
