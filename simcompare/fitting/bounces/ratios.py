"""Restitution from ratios of neighbouring flights, and by other rules than the fit's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_forms import OtherEstimate


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


def of_drops(drops: Sequence[Impacts]) -> list[OtherEstimate]:
    """Restitutions by other rules than the fit's; the ones that text books give."""
    return [row for number, drop in enumerate(drops, start=1) for row in _of_drop(number, drop)]


def _of_drop(number: int, drop: Impacts) -> list[OtherEstimate]:
    try:
        best = ratios(drop)
    except InputError:
        return []
    about: dict[str, Any] = {"drop": number, "source": drop.source}
    rows = [
        OtherEstimate(
            **about, rule="mean ratio", value=best.mean, u=best.u_mean, trend=best.trend,
            u_trend=best.u_trend,
        ),
        OtherEstimate(
            **about, rule="first ratio", value=float(best.values[0]), u=float(best.u[0])
        ),
    ]  # fmt: skip
    flights = drop.flights
    if len(flights.numbers) > 2:
        slope = float(np.polyfit(flights.numbers, np.log(flights.lengths_s), 1)[0])
        rows.append(OtherEstimate(**about, rule="line", value=float(np.exp(slope)), u=None))
    return rows
