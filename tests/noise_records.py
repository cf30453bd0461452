"""Records of noise whose truth is known."""

from __future__ import annotations

import numpy as np
from scipy import signal

from simcompare.model.trajectory import Array

#: NBS Monograph 140, annex 8.E
NBS14_PHASE = np.array(
    [0, 103.11111, 123.22222, 157.33333, 166.44444, 48.55555, -96.33333, -2.22222, 111.88889, 0.0]
)


def thousand_points() -> Array:
    """The rates of NIST SP 1065, 12.4."""
    number, values = 1234567890, []
    for _ in range(1000):
        values.append(number / 2147483647)
        number = 16807 * number % 2147483647
    return np.array(values)


def white(generator: np.random.Generator, count: int, rate_Hz: float) -> Array:
    """Readings with N = 1 per square root of hertz."""
    return float(np.sqrt(rate_Hz)) * generator.normal(size=count)


def flicker(generator: np.random.Generator, count: int) -> Array:
    """Readings with B = 1: white noise summed up half (N. J. Kasdin and T. Walter, 1992)."""
    k = np.arange(1, 2 * count)
    response = np.concatenate(([1.0], np.cumprod((k - 0.5) / k)))
    long = signal.fftconvolve(generator.normal(size=2 * count), response)
    return np.asarray(long[count : 2 * count])


def walk(generator: np.random.Generator, count: int, rate_Hz: float) -> Array:
    """Readings with K = 1 per square root of second."""
    return np.cumsum(generator.normal(size=count)) / float(np.sqrt(rate_Hz))


def angle(generator: np.random.Generator, count: int, rate_Hz: float) -> Array:
    """Readings with Q = 1: differences of an angle that is read with an error of 1."""
    return np.diff(generator.normal(size=count + 1)) * rate_Hz


def gauss_markov(
    generator: np.random.Generator, count: int, rate_Hz: float, time_s: float
) -> Array:
    """Readings of standard deviation 1 that forget over a time."""
    phi = np.exp(-1 / (rate_Hz * time_s))
    steps = generator.normal(size=2 * count) * np.sqrt(1 - phi**2)
    return np.asarray(signal.lfilter([1.0], [1.0, -phi], steps)[count:])
