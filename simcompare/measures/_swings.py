"""Passages through a level and turning points of something that swings, from positions alone.

Made for engines and for encoders: noise, steps of a count, uneven times and a start in mid-swing
are all allowed. A passage counts when the probe leaves a band on one side of the level after having
left it on the other; its time is the root of a cubic fitted to the samples around it. A turning
point is the vertex of an even curve fitted to the samples about the outermost one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from simcompare.measures import Request
from simcompare.model.trajectory import Array, Trajectory

#: part of the amplitude about the level whose samples tell a passage; there a sine is nearly cubic
NEAR_PART = 0.35
#: part of the amplitude above which samples tell a turning point
TOP_PART = 0.95
#: samples that a cubic needs, and from which on a quartic is fitted to a turning point
MIN_SAMPLES, MANY_SAMPLES = 4, 9


@dataclass(frozen=True)
class Swings:
    """What was found of a swinging probe.

    Attributes:
        passage_s: times of the passages through the level (n,).
        upward: whether each goes up (n,).
        amplitude: distance of the turning point after each passage from the level (n - 1,).
        turn_s: times of these turning points (n - 1,).
    """

    passage_s: Array
    upward: Array
    amplitude: Array
    turn_s: Array

    @property
    def full(self) -> int:
        """Number of full swings, each from a passage to the next but one, overlapping by half."""
        return max(len(self.passage_s) - 2, 0)


def of(trajectory: Trajectory, request: Request) -> Swings:
    """Swings of the leading probe about the ``level`` of the options, beyond their ``band``."""
    level, band = request.options["level"], request.options["band"]
    return find(trajectory.time_s, request.observed(trajectory), level, band)


def find(time_s: Array, values: Array, level: float, band: float) -> Swings:
    """Passages and turning points of a probe.

    Args:
        time_s: sample times, growing (n,) [s].
        values: the probe (n,).
        level: where it would rest.
        band: what it must leave on both sides of the level to count as swinging.
    """
    away = values - level
    side = np.where(away > band, 1, np.where(away < -band, -1, 0))
    outside = np.flatnonzero(side)
    changes = np.flatnonzero(np.diff(side[outside])) if len(outside) else np.array([], dtype=int)
    last, first = outside[changes], outside[changes + 1]
    if len(last) == 0:
        nothing = np.array([])
        return Swings(nothing, nothing, nothing, nothing)
    turns = [
        _turn(time_s[a : b + 1], away[a : b + 1]) for a, b in zip(first[:-1], last[1:], strict=True)
    ]
    amplitude = np.array([size for _, size in turns])
    passages = [
        _passage(time_s, away, (int(last[k]), int(first[k])), _about(amplitude, k))
        for k in range(len(last))
    ]
    return Swings(
        np.array(passages), side[first] > 0, amplitude, np.array([time for time, _ in turns])
    )


def _about(amplitude: Array, k: int) -> float:
    """Amplitude about passage k: the smaller of its neighbours, 0 where there is none."""
    around = amplitude[max(k - 1, 0) : k + 1]
    return float(around.min()) if len(around) else 0.0


def _passage(time_s: Array, away: Array, between: tuple[int, int], amplitude: float) -> float:
    """Time at which a probe passes 0 between two samples that are on either side of it."""
    near = NEAR_PART * amplitude
    first, behind = _widened(
        lambda k: bool(abs(away[k]) < near), (between[0], between[1] + 1), len(away), MIN_SAMPLES
    )
    start_s, end_s = float(time_s[between[0]]), float(time_s[between[1]])
    before, after = away[between[0]], away[between[1]]
    straight = start_s + (end_s - start_s) * float(before / (before - after))
    if behind - first < MIN_SAMPLES:
        return straight
    fitted = Polynomial.fit(time_s[first:behind], away[first:behind], 3)
    inside = np.sort(_roots(fitted, (start_s, end_s), end_s))
    if len(inside) == 0:
        return straight
    return float(inside[np.argmin(np.abs(inside - straight))])


def _turn(time_s: Array, away: Array) -> tuple[float, float]:
    """Time and distance of the turning point in samples that are all on one side."""
    distance = np.abs(away)
    top = int(np.argmax(distance))
    near = TOP_PART * distance[top]
    first, behind = _widened(lambda k: bool(distance[k] >= near), (top, top + 1), len(distance), 3)
    if behind - first < 3:
        return float(time_s[top]), float(distance[top])
    degree = 4 if behind - first >= MANY_SAMPLES else 2
    fitted = Polynomial.fit(time_s[first:behind], distance[first:behind], degree)
    ends_s = (float(time_s[first]), float(time_s[behind - 1]))
    inside = _roots(fitted.deriv(), ends_s, float(time_s[top]))
    if len(inside) == 0:
        return float(time_s[top]), float(distance[top])
    best = float(inside[np.argmax(fitted(inside))])
    return best, float(fitted(best))


def _widened(
    near: Callable[[int], bool], window: tuple[int, int], count: int, least: int
) -> tuple[int, int]:
    """A window, up to before its end, with its near neighbours; at least so many samples."""
    first, behind = window
    while first > 0 and near(first - 1):
        first -= 1
    while behind < count and near(behind):
        behind += 1
    while behind - first < least and (first > 0 or behind < count):
        first, behind = max(first - 1, 0), min(behind + 1, count)
    return first, behind


def _roots(polynomial: Polynomial, ends_s: tuple[float, float], about_s: float) -> Array:
    """Real roots between two times; what rounding makes of them beside the real axis counts."""
    roots = polynomial.roots()
    real = roots[np.abs(roots.imag) < 1e-9 * max(abs(about_s), 1.0)].real
    return np.asarray(real[(real >= ends_s[0]) & (real <= ends_s[1])], dtype=float)


def lengthening(amplitude_rad: Array) -> Array:
    """How many times longer than a small swing one of a pendulum takes: 2·K(sin²(A/2))/π.

    By the arithmetic-geometric mean, 1/agm(1, cos(A/2)) (Gauss); not a number from A = π on, where
    a pendulum does not swing.
    """
    a = np.ones(len(amplitude_rad))
    b = np.where(np.abs(amplitude_rad) < math.pi, np.cos(amplitude_rad / 2), math.nan)
    for _ in range(8):  # each doubles the digits
        a, b = (a + b) / 2, np.sqrt(a * b)
    return np.asarray(1 / a, dtype=float)
