"""A steady drift of a rate: its slope, and how well noise lets it be known."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array

#: variance of the slope of a line for a noise of 1 over 1 s: white angle, white, flicker, walk
_ANGLE, _WHITE, _FLICKER, _WALK = 72.0, 12.0, 9.0 / math.pi, 6.0 / 5.0


@dataclass(frozen=True)
class Ramp:
    """A slope with its standard uncertainty, in the unit of the rate per second."""

    slope: float
    u: float

    def seen(self, times: float) -> bool:
        """Whether it is so many standard uncertainties from 0."""
        return abs(self.slope) > times * self.u


def ramp_of(rates: Array, rate_Hz: float, noise: Mapping[str, float]) -> Ramp:
    """Slope of the least-squares line through a record.

    Args:
        rates: evenly spaced readings (n,).
        rate_Hz: how many there are in a second.
        noise: coefficients Q, N, B and K of the record, and "GM" with "GM time".
    """
    time = np.arange(len(rates), dtype=np.float64) - (len(rates) - 1) / 2
    slope = float(time @ rates) / float(time @ time) * rate_Hz
    return Ramp(slope, math.sqrt(_variance(len(rates) / rate_Hz, noise)))


def _variance(length_s: float, noise: Mapping[str, float]) -> float:
    """Of the slope, for a record of that length."""
    white, walk = noise.get("N", 0.0) ** 2, noise.get("K", 0.0) ** 2
    flicker, markov = noise.get("B", 0.0) ** 2, noise.get("GM", 0.0) ** 2
    # a Gauss-Markov noise is white over times much longer than its own
    white += 2 * markov * noise.get("GM time", 0.0)
    angle = _ANGLE * noise.get("Q", 0.0) ** 2 / length_s**4 + _WHITE * white / length_s**3
    return angle + _FLICKER * flicker / length_s**2 + _WALK * walk / length_s
