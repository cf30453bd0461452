"""Tests of whether a stream at rest can be the noise of a sensor at all.

Each gives the chance of so extreme a stream without the fault. What moves slowly, such as a bias,
is taken off first: readings count from the mean of their block of 32, or two by two.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.statistics.noise import autocovariance, correlation_length

_BLOCK = 32
#: lags below which filters correlate readings
_NEAR = 64
#: readings that differ by less than this part of all are the same but for rounding of numbers
_SAME = 1e-9
#: excess kurtosis of uniform numbers, and how near it is called so
_UNIFORM, _NEARLY = -1.2, 0.4


@dataclass(frozen=True)
class Told:
    """One test: the chance without the fault, and what was seen."""

    p: float
    text: str


def white_part(values: Array) -> Array:
    """Readings less the mean of their block (n,), at most 31 fewer."""
    count = len(values) // _BLOCK * _BLOCK
    blocks = values[:count].reshape(-1, _BLOCK)
    return np.asarray((blocks - blocks.mean(axis=1, keepdims=True)).ravel())


def smallest_step(values: Array) -> float:
    """Size of one count; 0 where readings are not quantised."""
    steps = np.diff(np.unique(values))
    steps = steps[steps > _SAME * np.ptp(values)]  # arithmetic does not give a count twice
    if not len(steps):
        return 0.0
    step = float(np.median(steps[steps <= 1.5 * steps.min()]))
    counts = steps / step
    whole = np.abs(counts - np.round(counts)).max() < 0.05
    return step if whole and len(steps) < len(values) / 2 else 0.0


def normal(values: Array) -> Told | None:
    """Whether the noise is normal, by skewness and kurtosis (D'Agostino and Pearson, 1973)."""
    from scipy import stats

    differences = _differences(values)
    if len(differences) < 100 or smallest_step(values) >= differences.std():
        return None
    p = float(stats.normaltest(differences).pvalue)
    excess = 2 * float(stats.kurtosis(differences))  # that of one reading
    if abs(excess - _UNIFORM) < _NEARLY:
        return Told(p, f"numbers are uniform, not normal (excess kurtosis {excess:.2f})")
    tails = "heavier" if excess > 0 else "lighter"
    return Told(p, f"numbers are not normal, tails are {tails} (excess kurtosis {excess:.2f})")


def _differences(values: Array) -> Array:
    """Of pairs of readings, so far apart that no filter correlates them.

    Normal where the noise is, also where a bias wanders; and independent of each other.
    """
    every = max(1, math.ceil(correlation_length(white_part(values)[:4096]) - 0.2))
    thinned = values[::every]
    return np.asarray(thinned[1::2] - thinned[: len(thinned) // 2 * 2 : 2])


def repeated(values: Array) -> Told:
    """Whether the noise repeats itself after some time, as a table of numbers does."""
    from scipy import stats

    white = white_part(values)
    white = white / (white.std() or 1.0)
    lags = np.arange(_NEAR, len(white) // 2)
    if not len(lags):
        return Told(1.0, "")
    z = autocovariance(white)[lags] * len(white) / np.sqrt(len(white) - lags)
    best = int(np.argmax(z))
    # a filter makes correlations scatter more
    spread = math.sqrt(correlation_length(white[:4096]))
    p = min(1.0, len(lags) * float(stats.norm.sf(z[best] / spread)))
    return Told(p, f"the same numbers come again after {int(lags[best])} readings")


def same_numbers(one: Array, other: Array) -> Told:
    """Whether two axes have the same noise, or a part of it."""
    from scipy import stats

    a, b = white_part(one), white_part(other)
    if not (a.std() > 0 and b.std() > 0):
        return Told(1.0, "")
    r = float(np.corrcoef(a, b)[0, 1])
    size = len(a) / correlation_length(a[:4096])
    p = 2 * float(stats.norm.sf(abs(math.atanh(np.clip(r, -0.999999, 0.999999))) * math.sqrt(size)))
    return Told(p, f"their noise is the same, or shared (correlation {r:.2f})")


def held(values: Array) -> Told:
    """Whether readings are given several times, more often than by rounding."""
    from scipy import stats

    steps = np.diff(values)
    moving = steps[steps != 0]
    share = 1 - len(moving) / len(steps)
    # of two normal readings that differ by less than a count
    spread = float(moving.std()) if len(moving) else 0.0
    by_rounding = smallest_step(values) / (math.sqrt(2 * math.pi) * spread) if spread else 1.0
    if share <= 0.02 + 2 * by_rounding:
        return Told(1.0, "")
    z = (share - by_rounding) * math.sqrt(len(steps))
    return Told(
        float(stats.norm.sf(z)), f"readings repeat the one before ({100 * share:.0f} % of them)"
    )


def holm(chances: list[float], family: float) -> list[bool]:
    """Which tests fail, so that at most this part of all clean streams has any (S. Holm, 1979)."""
    order = sorted(range(len(chances)), key=chances.__getitem__)
    fails = [False] * len(chances)
    for rank, i in enumerate(order):
        if chances[i] > family / (len(chances) - rank):
            break
        fails[i] = True
    return fails
