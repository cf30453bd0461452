"""Restitution from ratios of neighbouring flights, which no clock's offset or rate can change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.model.trajectory import Array


@dataclass(frozen=True)
class Ratios:
    """e_n = T_{n+1}/T_n of each impact between two whole flights.

    Attributes:
        numbers: which impacts.
        values: the ratios (n,).
        u: their standard uncertainties, NaN where those of the times are unknown (n,).
        covariance: of the ratios, which share flights (n, n).
        mean: the generalised least-squares mean.
        u_mean: its standard uncertainty.
        trend: by how much the ratio rises from impact to impact.
        u_trend: its standard uncertainty.
    """

    numbers: tuple[int, ...]
    values: Array
    u: Array
    covariance: Array
    mean: float
    u_mean: float
    trend: float
    u_trend: float


def ratios(impacts: Impacts) -> Ratios:
    """Ratios of neighbouring flights, both of whose ends were recorded.

    Raises:
        InputError: no two flights follow each other.
    """
    flights = impacts.flights
    at = np.flatnonzero(np.diff(flights.numbers) == 1) + 1
    if not len(at):
        raise InputError(
            impacts.source or "impacts",
            ["no two whole flights follow each other; a ratio needs three impacts in a row"],
        )
    numbers, known = flights.numbers[at], flights.u_known
    before = flights.lengths_s[at - 1]
    values = flights.lengths_s[at] / before
    change = np.zeros((len(at), len(flights.numbers)))
    rows = np.arange(len(at))
    change[rows, at - 1] = -values / before
    change[rows, at] = 1 / before
    covariance = change @ flights.covariance_s2 @ change.T
    mean, u_mean, trend, u_trend = _line(numbers.astype(float), values, covariance, known)
    u = np.sqrt(np.diag(covariance)) if known else np.full(len(values), np.nan)
    return Ratios(tuple(numbers.tolist()), values, u, covariance, mean, u_mean, trend, u_trend)


def _line(
    number: Array, values: Array, covariance: Array, known: bool
) -> tuple[float, float, float, float]:
    """Weighted mean and weighted slope with their uncertainties."""
    weight = np.linalg.inv(covariance)
    ones = np.ones((len(values), 1))
    steps = np.column_stack((ones[:, 0], number - number.mean()))
    found = []
    for design in (ones, steps[:, : min(2, len(values))]):
        cov = np.linalg.inv(design.T @ weight @ design)
        best = cov @ design.T @ weight @ values
        residual = values - design @ best
        degrees = len(values) - design.shape[1]
        scale = float(residual @ weight @ residual) / degrees if degrees else 1.0
        factor = max(1.0, scale) if known else (scale if degrees else np.nan)
        found.append((float(best[-1]), float(np.sqrt(factor * cov[-1, -1]))))
    (mean, u_mean), (trend, u_trend) = found
    return (mean, u_mean, trend, u_trend) if len(values) > 1 else (mean, u_mean, 0.0, np.inf)
