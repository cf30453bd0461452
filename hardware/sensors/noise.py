"""Noise of a sensor in three parts, as IEEE Std 952 names them, for many devices at once.

White noise of a one-sided density n [unit/√Hz] has the Allan deviation N/√τ with N = n/√2.
Bias instability B is flicker noise: its power density is B²/(π·f), one-sided, and its Allan
deviation flat at √(2·ln 2/π)·B = 0.664·B. A random walk K [unit/√s] has K·√(τ/3).

Flicker noise is white noise that is summed up half (N. J. Kasdin and T. Walter, 1992), over as many
samples as the record has, so it is in its steady state from the first sample on. The random walk
begins at 0: what it did before is part of the offset.
"""

from __future__ import annotations

import math

import numpy as np

from simcompare.hardware.sensors.low_pass import noise_filter, through
from simcompare.model.trajectory import Array


def white(
    density: Array, step_s: Array, count: int, generator: np.random.Generator,
    bandwidth_Hz: float = math.inf, poles: int = 1,
) -> Array:  # fmt: skip
    """White noise of devices and axes (d, k, n) after a low-pass.

    Args:
        density: one-sided (d, k) [unit/√Hz].
        step_s: time between samples (d,) [s].
        count: samples n.
        generator: of the numbers.
        bandwidth_Hz: -3 dB of the low-pass, infinite for none.
        poles: of the low-pass.
    """
    if not np.any(density):
        return np.zeros((*density.shape, count))
    is_smooth = not math.isinf(bandwidth_Hz)
    # behind a low-pass the variance is that of the filter, at any rate
    step = np.full(len(density), np.mean(step_s)) if is_smooth else step_s
    b, a = noise_filter(float(step[0]), bandwidth_Hz, poles)
    first = generator.standard_normal((*density.shape, len(a) - 1))
    numbers = generator.standard_normal((*density.shape, count))
    size = density / np.sqrt(2 * step)[:, None]
    return size[..., None] * through(numbers, b, a, first)


def flicker(instability: Array, count: int, generator: np.random.Generator) -> Array:
    """Bias instability of devices and axes (d, k, n); ``instability`` is B (d, k) [unit]."""
    if not np.any(instability):
        return np.zeros((*instability.shape, count))
    from scipy import fft

    # as many samples before the first one as there are: none of the sums wraps around
    size = fft.next_fast_len(2 * count, real=True)
    numbers = fft.rfft(generator.standard_normal((*instability.shape, size)), axis=-1)
    summed = fft.irfft(numbers * fft.rfft(_half_sum(count), size), size, axis=-1)
    return np.asarray(instability[..., None] * summed[..., size - count :], dtype=float)


def _half_sum(count: int) -> Array:
    """What is left after 0, 1, 2, … samples of a number that is summed up half."""
    k = np.arange(1, count)
    return np.concatenate(([1.0], np.cumprod((k - 0.5) / k)))


def random_walk(walk: Array, step_s: Array, count: int, generator: np.random.Generator) -> Array:
    """Random walk of devices and axes (d, k, n) from 0; ``walk`` is K (d, k) [unit/√s]."""
    if not np.any(walk):
        return np.zeros((*walk.shape, count))
    steps = generator.standard_normal((*walk.shape, count))
    steps[..., 0] = 0.0
    return (walk * np.sqrt(step_s)[:, None])[..., None] * np.cumsum(steps, axis=-1)
