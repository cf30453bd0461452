"""Coefficients of the noises that an Allan plot shows (IEEE Std 952, annex C).

Overlapping Allan variances are fitted by a sum of non-negative noise variances with the full
covariance of the fitted mixture (:mod:`simcompare.statistics.allan_covariance`). A noise without
which the record is hardly less likely gets an upper limit instead of a number. A ramp is the slope
of the whole record; where there is one, Hadamard variances are fitted instead, which it leaves
alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.statistics import allan_covariance as cov
from simcompare.statistics.allan_fit import ALLAN, HADAMARD, NAMES, SEEN, Fit, fit_of, with_markov

#: one-sided 95 % of the normal distribution
_LIMIT = 1.645
#: variance of the slope of a line for a noise of 1 over 1 s: white angle, white, flicker, walk
_ANGLE, _WHITE, _FLICKER, _WALK = 72.0, 12.0, 9.0 / math.pi, 6.0 / 5.0


@dataclass(frozen=True)
class Term:
    """One noise: a number with its uncertainty, or an upper limit.

    Attributes:
        name: "N", "B", "K", "Q" or "R".
        value: the coefficient; NaN where the record does not show it.
        u: its standard uncertainty; NaN where the record does not show it.
        limit: the coefficient is below this with 95 % probability.
    """

    name: str
    value: float
    u: float
    limit: float

    @property
    def seen(self) -> bool:
        """Whether the record shows it."""
        return math.isfinite(self.value)


@dataclass(frozen=True)
class GaussMarkov:
    """Noise that forgets: correlated over a time of its own.

    Attributes:
        sigma: its standard deviation, in the unit of the rate.
        u_sigma: standard uncertainty of it.
        time_s: its correlation time [s].
        u_time_s: standard uncertainty of it [s].
    """

    sigma: float
    u_sigma: float
    time_s: float
    u_time_s: float


@dataclass(frozen=True, eq=False)
class Terms:
    """All noises of a record.

    Attributes:
        interval_s: between samples [s].
        terms: N, B, K, Q and R, in this order.
        gauss_markov: where the record shows one.
        chi_squared: of the Allan variances about the fit.
        degrees_of_freedom: of it.
        from_s: shortest averaging time that was fitted; shorter ones are smoothed by a filter [s].
        widened: factor on all standard uncertainties, above 1 where the noises do not describe the
            variances: the root of chi-squared over its degrees of freedom.
        order: 2 where Allan variances were fitted, 3 for Hadamard variances.
    """

    interval_s: float
    terms: tuple[Term, ...]
    gauss_markov: GaussMarkov | None
    chi_squared: float
    degrees_of_freedom: int
    from_s: float
    widened: float
    order: int

    def __getitem__(self, name: str) -> Term:
        return next(term for term in self.terms if term.name == name)

    def deviation(self, name: str, tau_s: Array) -> Array:
        """Allan deviation of one noise: "N", "B", "K", "Q", "R" or "GM"; 0 where it is not seen."""
        m = np.asarray(tau_s) / self.interval_s
        if name == "GM":
            found = self.gauss_markov
            if found is None:
                return np.zeros(len(m))
            kernel = cov.gauss_markov(found.time_s / self.interval_s)
            return np.asarray(found.sigma * np.sqrt(cov.shape(kernel, m)))
        value = np.nan_to_num(self[name].value)
        if name == "R":
            return np.asarray(abs(value) * tau_s / math.sqrt(2))
        kernel_of = cov.kernels()[name]
        return np.asarray(value / _unit(name, self.interval_s) * np.sqrt(cov.shape(kernel_of, m)))

    def total(self, tau_s: Array) -> Array:
        """Allan deviation of all noises that are seen."""
        squares = [self.deviation(name, tau_s) ** 2 for name in (*NAMES, "R", "GM")]
        return np.asarray(np.sqrt(sum(squares)))


def fitted(rates: Array, rate_Hz: float) -> Terms:
    """The noises of a record of evenly spaced readings."""
    drift_free = fit_of(rates, HADAMARD)
    ramp = ramp_of(rates, rate_Hz, _noise(drift_free, 1 / rate_Hz))
    order = HADAMARD if ramp.seen(math.sqrt(SEEN)) else ALLAN
    fit = drift_free if order == HADAMARD else fit_of(rates, ALLAN)
    return _told(with_markov(fit), 1 / rate_Hz, ramp)


def _noise(fit: Fit, interval_s: float) -> Mapping[str, float]:
    """Coefficients that are seen, and a random walk somewhat larger than is likely if it is not."""
    found = {
        name: math.sqrt(variance) * _unit(name, interval_s)
        for name, variance in fit.variances.items() if name in NAMES
    }  # fmt: skip
    found.setdefault("K", fit.limit("K", 0.25) * _unit("K", interval_s))
    if "GM" in fit.variances:
        found["GM"] = math.sqrt(fit.variances["GM"])
        found["GM time"] = fit.length * interval_s
    return found


def _told(fit: Fit, interval_s: float, ramp: Ramp) -> Terms:
    """As coefficients."""
    wider = 1.0 if fit.describes else math.sqrt(fit.chi_squared / fit.degrees_of_freedom)
    terms = [_term(fit, name, interval_s, wider) for name in ("N", "B", "K", "Q")]
    order = fit.observed.order
    slope, u = (ramp.slope, ramp.u * wider) if order == HADAMARD else (math.nan, math.nan)
    terms.append(Term("R", slope, u, abs(ramp.slope) + _LIMIT * ramp.u * wider))
    return Terms(interval_s, tuple(terms), _markov(fit, interval_s, wider), fit.chi_squared,
                 fit.degrees_of_freedom, float(fit.observed.factors[0]) * interval_s, wider,
                 order)  # fmt: skip


def _term(fit: Fit, name: str, interval_s: float, wider: float) -> Term:
    unit = _unit(name, interval_s)
    if name in fit.variances:
        value = math.sqrt(fit.variances[name])
        u = fit.u[name] / (2 * value) * wider
        return Term(name, value * unit, u * unit, (value + _LIMIT * u) * unit)
    # twice the fall of the log-likelihood grows with the square of the factor
    return Term(name, math.nan, math.nan, fit.limit(name, (_LIMIT * wider) ** 2) * unit)


def _markov(fit: Fit, interval_s: float, wider: float) -> GaussMarkov | None:
    if "GM" not in fit.variances:
        return None
    sigma = math.sqrt(fit.variances["GM"])
    return GaussMarkov(sigma, wider * fit.u["GM"] / (2 * sigma),
                       fit.length * interval_s, wider * fit.u_length * interval_s)  # fmt: skip


def _unit(name: str, interval_s: float) -> float:
    """A coefficient for 1 in the unit of the rate per sample."""
    power = {"Q": 1.0, "N": 0.5, "B": 0.0, "K": -0.5}[name]
    return float(interval_s**power)


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
