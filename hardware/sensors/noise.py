"""Noise of a sensor in three parts, as IEEE Std 952 names them, for many devices at once.

White noise of a one-sided density n [unit/√Hz] has the Allan deviation N/√τ with N = n/√2.
Bias instability B is flicker noise: its power density is B²/(π·f), one-sided, and its Allan
deviation flat at √(2·ln 2/π)·B = 0.664·B. A random walk K [unit/√s] has K·√(τ/3).

Flicker noise is made of Gauss-Markov processes of equal variance B²·ln(r)/π whose correlation times
grow by a factor r = 4 from one sample to four times the whole record; the sum of their spectra is
1/f to 0.2 % between. All are in their steady state at the first sample. The random walk begins
at 0: what it did before is part of the offset.
"""

from __future__ import annotations

import math

import numpy as np

from simcompare.hardware.sensors.low_pass import noise_filter, through
from simcompare.model.trajectory import Array

#: ratio of neighbouring correlation times of flicker noise
_RATIO = 4.0


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


def flicker(instability: Array, step_s: float, count: int, generator: np.random.Generator) -> Array:
    """Bias instability of devices and axes (d, k, n); ``instability`` is B (d, k) [unit]."""
    total: Array = np.zeros((*instability.shape, count))
    if not np.any(instability):
        return total
    for time_s in correlation_times_s(step_s, count):
        kept = math.exp(-step_s / time_s)
        b, a = np.array([math.sqrt(1 - kept**2)]), np.array([1.0, -kept])
        first = generator.standard_normal((*instability.shape, 1))
        total += through(np.asarray(generator.standard_normal(total.shape)), b, a, first)
    return instability[..., None] * math.sqrt(math.log(_RATIO) / math.pi) * total


def correlation_times_s(step_s: float, count: int) -> Array:
    """Correlation times of the Gauss-Markov processes of flicker noise [s]."""
    processes = 2 + math.ceil(math.log(max(count, 2), _RATIO))
    return np.asarray(step_s * _RATIO ** np.arange(processes), dtype=float)


def random_walk(walk: Array, step_s: Array, count: int, generator: np.random.Generator) -> Array:
    """Random walk of devices and axes (d, k, n) from 0; ``walk`` is K (d, k) [unit/√s]."""
    if not np.any(walk):
        return np.zeros((*walk.shape, count))
    steps = generator.standard_normal((*walk.shape, count))
    steps[..., 0] = 0.0
    return (walk * np.sqrt(step_s)[:, None])[..., None] * np.cumsum(steps, axis=-1)
