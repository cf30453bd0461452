"""Where two waveforms look alike: correlation with gaps, different rates and different lengths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from simcompare.errors import InputError
from simcompare.model.trajectory import Array

#: an interval longer than this many median intervals is a gap
GAP = 2.0
#: two signals must have this share of the shorter one in common
MIN_OVERLAP = 0.5
_MIN_SAMPLES = 8
#: samples of the common grid; longer signals are averaged to a coarser one
_MAX_SAMPLES = 400_000


@dataclass(frozen=True)
class Wave:
    """A sampled signal without its missing samples.

    Attributes:
        time_s: (n,), increasing [s].
        values: (n,).
        step_s: median interval [s].
    """

    time_s: Array
    values: Array
    step_s: float


def wave_of(time_s: ArrayLike, values: ArrayLike, which: str) -> Wave:
    """A signal for alignment; NaN are left out, and a long interval counts as a gap.

    Args:
        time_s: times (n,), increasing [s].
        values: values (n,).
        which: whose they are, for messages.

    Raises:
        InputError: times do not increase, too few samples, or a constant signal.
    """
    t, y = np.asarray(time_s, dtype=float).ravel(), np.asarray(values, dtype=float).ravel()
    where = f"alignment, {which}"
    if len(t) != len(y):
        raise InputError(where, [f"{len(t)} times and {len(y)} values; give one value per time"])
    known = np.isfinite(t) & np.isfinite(y)
    t, y = t[known], y[known]
    if len(t) < _MIN_SAMPLES:
        raise InputError(where, [f"only {len(t)} samples; expected at least {_MIN_SAMPLES}"])
    steps = np.diff(t)
    if not np.all(steps > 0):
        k = int(np.argmin(steps))
        text = f"time {t[k + 1]:g} s does not come after {t[k]:g} s; sort the samples first"
        raise InputError(where, [text])
    if np.ptp(y) == 0:
        raise InputError(where, [f"the signal is {y[0]:g} throughout; nothing to align by"])
    return Wave(t, y, float(np.median(steps)))


def peaks(reference: Wave, log: Wave) -> tuple[list[float], float]:
    """Offsets with a high correlation, best first, and the step of the common grid [s].

    The correlation coefficient counts only samples that both have (D. Padfield, Masked object
    registration in the Fourier domain, IEEE Trans. Image Process. 21 (2012) 2706). The vertex of
    the parabola through a peak and its neighbours is the offset.

    Args:
        reference: the reference's signal.
        log: the log's signal.

    Raises:
        InputError: no offset has enough in common.
    """
    spans = float(np.ptp(reference.time_s)) + float(np.ptp(log.time_s))
    step = max(reference.step_s, log.step_s, spans / _MAX_SAMPLES)
    y_ref, y_log = _gridded(reference, step), _gridded(log, step)
    height = _correlation(y_ref, y_log)
    first = log.time_s[0] - reference.time_s[0]
    offsets = first + step * (np.arange(len(height)) - (len(y_ref) - 1))
    allowed = np.isfinite(height)
    if not allowed.any():
        text = "at no offset do the two signals have half of the shorter one in common"
        raise InputError("alignment", [text])
    return _local(offsets, np.where(allowed, height, -np.inf), step), step


def _gridded(wave: Wave, step: float) -> Array:
    """Values on a grid from the first time on: means of a step, or interpolated; NaN in gaps."""
    count = int(np.floor((wave.time_s[-1] - wave.time_s[0]) / step + 1e-9)) + 1
    grid = wave.time_s[0] + step * np.arange(count)
    limit = GAP * max(wave.step_s, step)
    if wave.step_s < 0.7 * step:
        # a mean over one step of the slower signal is a low-pass without delay
        nearest = np.floor((wave.time_s - wave.time_s[0]) / step + 0.5).astype(int)
        inside = nearest < count
        total = np.bincount(nearest[inside], wave.values[inside], minlength=count)
        number = np.bincount(nearest[inside], minlength=count)
        return np.where(number > 0, total / np.maximum(number, 1), np.nan)
    values = np.interp(grid, wave.time_s, wave.values)
    after = np.clip(np.searchsorted(wave.time_s, grid, side="left"), 1, len(wave.time_s) - 1)
    between = wave.time_s[after] - wave.time_s[after - 1]
    return np.where(between <= limit, values, np.nan)


def _correlation(reference: Array, log: Array) -> Array:
    """Correlation coefficient at every lag; NaN where too little is in common."""
    from scipy.signal import correlate

    def of(a: Array, b: Array) -> Array:
        return np.asarray(correlate(a, b, mode="full", method="fft"))

    here, there = np.isfinite(reference), np.isfinite(log)
    m_ref, m_log = here.astype(float), there.astype(float)
    x = np.where(here, reference - np.nanmean(reference), 0.0)
    y = np.where(there, log - np.nanmean(log), 0.0)
    # of unit size, so that rounding in the transforms can be told from signal
    x, y = x / np.sqrt(np.mean(x**2)), y / np.sqrt(np.mean(y**2))
    n = np.round(of(m_log, m_ref))
    least = max(_MIN_SAMPLES, MIN_OVERLAP * min(m_ref.sum(), m_log.sum()))
    safe = np.maximum(n, 1)
    sum_x, sum_y = of(m_log, x), of(y, m_ref)
    covariance = of(y, x) - sum_x * sum_y / safe
    square_x = of(m_log, x**2) - sum_x**2 / safe
    square_y = of(y**2, m_ref) - sum_y**2 / safe
    # a part without movement looks like everything
    moving = np.minimum(square_x, square_y) > 1e-3 * safe
    bottom = np.sqrt(np.maximum(square_x * square_y, 1e-30))
    return np.where((n >= least) & moving, covariance / bottom, np.nan)


def _local(offsets: Array, height: Array, step: float) -> list[float]:
    """Local maxima that reach near the best one, with the vertex of a parabola each."""
    best = float(height.max())
    before = np.concatenate(([-np.inf], height[:-1]))
    after = np.concatenate((height[1:], [-np.inf]))
    tops = np.flatnonzero((height >= before) & (height > after) & (height > best - 0.15))
    offsets_s = []
    for k in tops[np.argsort(-height[tops], kind="stable")][:12]:
        a, b, c = before[k], height[k], after[k]
        bend = a - 2 * b + c
        shift = 0.5 * (a - c) / bend if np.isfinite(bend) and bend < 0 else 0.0
        offsets_s.append(float(offsets[k] + step * np.clip(shift, -0.5, 0.5)))
    return offsets_s
