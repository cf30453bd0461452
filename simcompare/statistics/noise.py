"""The noise of a measurement told from the measurement itself."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.statistics.agreement import MAD_TO_SD


@dataclass(frozen=True)
class Noise:
    """Standard deviation of a signal's noise.

    Attributes:
        value: in the unit of the signal.
        u: its own standard uncertainty.
        text: how it was found.
    """

    value: float
    u: float
    text: str


def measured_noise(values: ArrayLike) -> Noise:
    """Standard deviation of white noise on a smooth signal, by second differences.

    A second difference y[i-1] - 2·y[i] + y[i+1] has √6 times the noise of a sample and hardly any
    of a smooth signal (T. Gasser, L. Sroka and C. Jennen-Steinmetz, Biometrika 73 (1986) 625);
    the median of their absolute values is not moved by steps and impacts. Noise that was filtered
    before sampling looks smaller than it is. Steps of a counter or converter count as at least
    1/√12 of one step (JCGM 100:2008, 4.3.7).

    Args:
        values: the samples (n,), evenly spaced; NaN split the signal.

    Raises:
        InputError: fewer than five second differences.
    """
    y = np.asarray(values, dtype=float).ravel()
    second = y[:-2] - 2 * y[1:-1] + y[2:]
    second = second[np.isfinite(second)]
    if len(second) < 5:
        raise InputError("noise", [f"only {len(second)} second differences; expected 5 or more"])
    sigma = MAD_TO_SD * float(np.median(np.abs(second))) / math.sqrt(6)
    text = "from the median second difference of the measurement"
    least = _quantisation(y[np.isfinite(y)])
    if least > sigma:
        sigma, text = least, "from the smallest step that the measurement shows (1/√12 of it)"
    # a median absolute deviation has 37 % efficiency; neighbours share samples: 2/3 of them count
    return Noise(sigma, sigma * 1.17 / math.sqrt(max(1.0, 2 * len(second) / 3)), text)


def _quantisation(y: Array) -> float:
    """1/√12 of the step of a quantised signal; 0 where values hardly ever repeat."""
    distinct = np.unique(y)
    if len(distinct) < 2 or len(distinct) > len(y) / 2:
        return 0.0
    step = float(np.median(np.diff(distinct)))
    return step / math.sqrt(12)


def autocovariance(values: Array) -> Array:
    """Mean products of a record with itself, shifted by 0, 1, 2, … samples (n,).

    Args:
        values: the record, its mean taken off (n,).
    """
    size = 1 << (2 * len(values) - 1).bit_length()  # so that its end does not meet its start
    power = np.abs(np.fft.rfft(values, size)) ** 2
    return np.asarray(np.fft.irfft(power, size)[: len(values)] / len(values))


def correlation_length(residuals: Array) -> float:
    """Integrated autocorrelation of residuals in samples, at least 1.

    1 + 2·Σρ_k up to the first lag at which ρ is below 0 (initial positive sequence).

    Args:
        residuals: in order of time (n,).
    """
    centred = residuals - residuals.mean()
    correlation = autocovariance(np.asarray(centred))[: len(centred) // 2]
    if correlation[0] <= 0:
        return 1.0
    rho = correlation / correlation[0]
    negative = np.flatnonzero(rho < 0)
    end = int(negative[0]) if len(negative) else len(rho)
    return max(1.0, float(1 + 2 * rho[1:end].sum()))
