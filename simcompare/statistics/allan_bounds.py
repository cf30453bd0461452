"""How well a deviation is known: its noise type, degrees of freedom and confidence bounds.

Equivalent degrees of freedom are those of C. A. Greenhall and W. J. Riley, Uncertainty of stability
variances based on finite differences, 35th PTTI (2003), which NIST SP 1065, 5.4.1 repeats; of the
total deviation those of SP 1065, 5.4.4. The noise type comes from the autocorrelation at lag 1
(SP 1065, 5.5.6).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array
from simcompare.statistics.allan import Deviations, Kind

#: power of the frequency in the spectrum of the rate -> what such noise is called
NOISE_TYPES = {
    2: "white angle", 1: "flicker angle", 0: "white", -1: "flicker", -2: "random walk",
}  # fmt: skip
#: samples at an averaging time with which a noise type can be told
_LEAST_SAMPLES = 50
#: differences within one averaging time that are summed; more changes nothing that is seen
_FINEST = 256
#: total deviation: exponent -> b and c of b·T/τ - c
_TOTAL = {0: (1.5, 0.0), -1: (1.168, 0.222), -2: (0.927, 0.358)}


@dataclass(frozen=True, eq=False)
class Bounds:
    """A deviation with the interval that holds the true one.

    Attributes:
        alpha: power of the frequency in the spectrum of the rate (n,), from -2 to 2.
        told: whether the record itself shows it there (n,); else that of the longest averaging
            time at which it does.
        degrees_of_freedom: of the variance (n,).
        low: lower bounds (n,).
        high: upper bounds (n,).
        probability: with which the true deviation is between them.
    """

    alpha: NDArray[np.int64]
    told: NDArray[np.bool_]
    degrees_of_freedom: Array
    low: Array
    high: Array
    probability: float


def bounds(found: Deviations, phase: Array, probability: float = 0.95) -> Bounds:
    """Confidence bounds of a deviation, for the noise that the record itself shows.

    Args:
        found: of this record.
        phase: the record, as :func:`simcompare.statistics.allan.phase_of` gives it.
        probability: of the two-sided interval.
    """
    alpha, told = _alphas(found, phase)
    freedom = np.array([
        edf(found.kind, a, m, found.samples)
        for a, m in zip(alpha.tolist(), found.m.tolist(), strict=True)
    ])  # fmt: skip
    low, high = limits(found.values, freedom, probability)
    return Bounds(alpha, told, freedom, low, high, probability)


def limits(values: Array, freedom: Array, probability: float) -> tuple[Array, Array]:
    """Lower and upper bounds of deviations by the chi-squared distribution."""
    from scipy import stats

    above = stats.chi2.ppf((1 + probability) / 2, freedom)
    below = stats.chi2.ppf((1 - probability) / 2, freedom)
    return values * np.sqrt(freedom / above), values * np.sqrt(freedom / below)


def _alphas(found: Deviations, phase: Array) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """The type changes only where the exponent does by more than its own standard uncertainty."""
    alpha, told = [], []
    last: int | None = None
    for m in found.m.tolist():
        exponent = noise_exponent(phase, m)
        if exponent is not None:
            u = 2 / math.sqrt(len(phase) / m)
            if last is None or abs(exponent - last) > 0.5 + u:
                last = max(-2, min(2, round(exponent)))
        alpha.append(last or 0)
        told.append(exponent is not None)
    return np.array(alpha), np.array(told)


def noise_exponent(phase: Array, m: int) -> float | None:
    """Power of the frequency in the spectrum of the rate, averaged over m samples.

    2 is white phase, 0 a white rate, -1 flicker and -2 a random walk of the rate. ``None`` where
    fewer than 50 averages are left.
    """
    z = phase[::m]
    if len(z) <= _LEAST_SAMPLES:
        return None
    for differenced in range(4):
        z = z - z.mean()
        power = float(z @ z)
        if power == 0:
            return None
        lag = float(z[:-1] @ z[1:]) / power
        delta = lag / (1 + lag)
        if delta < 0.25:
            return 2 - 2 * (delta + differenced)
        z = np.diff(z)
    return -4.0


def edf(kind: Kind, alpha: int, m: int, samples: int) -> float:
    """Equivalent degrees of freedom of a variance.

    Args:
        kind: which deviation.
        alpha: power of the frequency in the spectrum of the rate, from -2 to 2.
        m: averaging factor.
        samples: number of rates in the record.
    """
    if kind == "totdev" and alpha in _TOTAL:
        b, c = _TOTAL[alpha]
        return max(1.0, b * samples / m - c)
    order = 3 if kind in ("hdev", "ohdev") else 2
    modified = kind in ("mdev", "tdev")
    stride = 1 if kind in ("adev", "hdev") else m
    length = (m if modified else 1) + m * order
    number = 1 + stride * max(0, samples + 1 - length) // m
    return max(1.0, _edf(alpha, order, m, number, stride, modified=modified))


def _edf(alpha: int, order: int, m: int, number: int, stride: int, *, modified: bool) -> float:
    """Greenhall and Riley's sum, over a coarser stride where it is very fine."""
    filtered = 1 if modified else m
    if alpha == 2 and not modified:  # only differences that share a phase are correlated
        lags = np.arange(order + 1) * stride
    else:
        coarse = min(stride, _FINEST)
        number, stride = max(1, round(number * coarse / stride)), coarse
        filtered = min(filtered, _FINEST)
        lags = np.arange((order + 1) * coarse)
    lags = lags[lags < number]
    square = _z(lags / stride, filtered, alpha, order) ** 2
    weights = 2 * (1 - lags / number)
    weights[0] = 1.0
    return float(number * square[0] / (weights @ square))


def _z(t: Array, filtered: int, alpha: int, order: int) -> Array:
    """Covariance of differences of the given order that are t averaging times apart."""
    weights = [(-1) ** k * math.comb(2 * order, order + k) for k in range(order + 1)]
    total = weights[0] * _x(t, filtered, alpha)
    for k, weight in enumerate(weights[1:], start=1):
        total = total + weight * (_x(t + k, filtered, alpha) + _x(t - k, filtered, alpha))
    return np.asarray(total)


def _x(t: Array, filtered: int, alpha: int) -> Array:
    """Covariance of phase averages."""
    step = 1 / filtered
    sides = _w(t - step, alpha) + _w(t + step, alpha)
    return np.asarray(filtered**2 * (2 * _w(t, alpha) - sides))


def _w(t: Array, alpha: int) -> Array:
    """Generalised covariance of the integral of phase whose rate has this power of frequency."""
    size = np.abs(t)
    logarithm = np.log(np.where(size > 0, size, 1.0)) if alpha % 2 else 1.0
    return np.asarray((1 if alpha in (0, 1) else -1) * size ** (3 - alpha) * logarithm)
