"""Whether a filter errs as much as it says: NEES, NIS and whiteness, each with its band.

NEES, the normalised error squared eᵀ·P⁻¹·e, needs the truth; NIS, yᵀ·S⁻¹·y, needs nothing but the
innovations. If the filter's model is right, they follow χ² with as many degrees of freedom as there
are states or readings, and innovations are white. Above its band a filter errs more than it says:
it is too sure, and may diverge. Below, it errs less: it is too careful.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from simcompare.estimation.estimate import Innovations, Way
from simcompare.estimation.kalman import Filtered
from simcompare.model.plain import Finite
from simcompare.model.trajectory import Array

#: probability of the bands
SHARE = 0.95
#: lags at which innovations are correlated with themselves
LAGS = 20
#: times its upper limit at which NEES or NIS mean that the filter has lost the truth
_LOST = 5.0
Outcome = Literal["consistent", "too sure", "too careful", "diverged", "not white"]


@dataclass(frozen=True)
class Verdict:
    """What one test of consistency found.

    Attributes:
        name: "NEES", "NIS" or "whiteness".
        value: mean over all instants and runs; for whiteness, the part of correlations in the band.
        low: lower limit of the band that the value should be in.
        high: upper limit.
        inside: part of the instants at which the mean over the runs is inside the band; ``None``
            for whiteness.
        degrees_of_freedom: states, or readings at one instant in the mean; lags for whiteness.
        runs: how many runs were averaged.
        outcome: what follows.
        lag_1: correlation of neighbouring innovations, of whiteness alone.
    """

    name: str
    value: Finite
    low: float
    high: float
    inside: float | None
    degrees_of_freedom: float
    runs: int
    outcome: Outcome
    lag_1: float | None = None


def band(degrees_of_freedom: float, count: int) -> tuple[float, float]:
    """95 % limits of the mean of so many independent χ² values."""
    from scipy.stats import chi2

    of_all = chi2(degrees_of_freedom * count)
    return float(of_all.ppf((1 - SHARE) / 2)) / count, float(of_all.ppf((1 + SHARE) / 2)) / count


def nees_of(errors: Array, covariances: Array) -> Array:
    """eᵀ·P⁻¹·e at each instant (n,) from errors (n, k) and covariances (n, k, k)."""
    weighted = np.linalg.solve(covariances, errors[..., None])[..., 0]
    return np.asarray(np.einsum("ni,ni->n", errors, weighted))


def nees_of_states(way: Way, covariances: Array) -> tuple[Array | None, int]:
    """The NEES of all states whose truth is known (n,), and how many those are.

    It is NaN where the truth is not known.
    """
    errors = [state.error for state in way.states.values()]
    known = np.flatnonzero([error is not None for error in errors])
    if not len(known):
        return None, 0
    rows = np.array([error for error in errors if error is not None]).T
    there = np.isfinite(rows).all(axis=1)
    found = np.full(len(rows), np.nan)
    part = covariances[np.ix_(np.flatnonzero(there), known, known)]
    found[there] = nees_of(rows[there], part)
    return found, len(known)


def innovations_of(
    filtered: Filtered, way: Way, names: Sequence[str], counted: tuple[str, ...] = ()
) -> Innovations:
    """What the consistency of a filter is judged by.

    Args:
        filtered: all that it went through.
        way: its states, beside the truth.
        names: of its readings.
        counted: those that are differences of counts.
    """
    ratios = filtered.innovations / filtered.innovation_u
    whitened = {name: ratios[np.isfinite(ratios[:, i]), i] for i, name in enumerate(names)}
    refused = {name: int(filtered.refused[:, i].sum()) for i, name in enumerate(names)}
    nees, states = nees_of_states(way, filtered.covariances)
    return Innovations(filtered.nis, filtered.used, whitened, refused, nees, states, counted)


def nees(values: Array, states: int) -> Verdict:
    """The test of errors.

    Neighbouring errors of one run are correlated, so only the runs count as independent.

    Args:
        values: NEES of each run at each instant (runs, n).
        states: number of states.
    """
    runs = len(values)
    low, high = band(states, runs)
    means = values[:, np.isfinite(values).all(axis=0)].mean(axis=0)
    inside = float(np.mean((means >= low) & (means <= high)))
    mean = float(means.mean())
    return Verdict("NEES", mean, low, high, inside, states, runs, _outcome(mean, low, high))


def nis(values: Array, used: Array) -> Verdict:
    """The test of innovations.

    Those of one run are independent from instant to instant, so a single run tells already, and
    each instant of each run makes the test sharper.

    Args:
        values: NIS of each run at each instant (runs, n), NaN where nothing was read.
        used: number of readings (runs, n).
    """
    there = np.isfinite(values)
    readings, count = float(np.sum(used[there])), int(there.sum())
    degrees, runs = readings / max(count, 1), len(values)
    low, high = band(degrees, count)
    mean = float(np.mean(values[there]))
    return Verdict("NIS", mean, low, high, _inside(values, used), degrees, runs,
                _outcome(mean, low, high))  # fmt: skip


def whiteness(innovations: Sequence[Array]) -> Verdict | None:
    """The test that no innovation tells of later ones: |ρ| < 1.96/√n at 95 % of 20 lags.

    Args:
        innovations: of each run and each reading, in units of their uncertainty (n,) without gaps.

    Returns:
        What was found; ``None`` where hardly anything was read.
    """
    from scipy.stats import binom

    counted, first = [], []
    for row in (row for row in innovations if len(row) > 2):
        rho = autocorrelation(row)
        counted += list(np.abs(rho) < 1.96 / math.sqrt(len(row)))
        first.append(rho[0])
    if not counted:
        return None
    share = float(np.mean(counted))
    # lags are whole numbers: of right filters less than one in a hundred has fewer inside, of one
    # series of 20 lags one in 400
    least = float(binom.ppf(0.01, len(counted), SHARE)) / len(counted)
    outcome: Outcome = "consistent" if share >= least else "not white"
    return Verdict("whiteness", share, least, 1.0, None, LAGS, len(innovations), outcome,
                float(np.mean(first)))  # fmt: skip


def autocorrelation(values: Array) -> Array:
    """ρ₁ … ρ₂₀ of a series (20,), or as many as it is long enough for."""
    centred = values - values.mean()
    power = float(centred @ centred) or 1.0
    lags = range(1, min(LAGS, len(values) - 1) + 1)
    return np.array([float(centred[lag:] @ centred[:-lag]) / power for lag in lags])


def _inside(values: Array, used: Array) -> float:
    """Part of the instants at which the mean over the runs is inside its band."""
    found = []
    for column, readings in zip(values.T, used.T, strict=True):
        there = np.isfinite(column)
        if there.any():
            count = int(there.sum())
            low, high = band(float(readings[there].mean()), count)
            found.append(low <= float(column[there].mean()) <= high)
    return float(np.mean(found)) if found else math.nan


def _outcome(mean: float, low: float, high: float) -> Outcome:
    if not math.isfinite(mean) or mean > _LOST * high:
        return "diverged"
    if mean > high:
        return "too sure"
    return "too careful" if mean < low else "consistent"
