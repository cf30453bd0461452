"""What one would have concluded with another residual: the choice of metric moves the answer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.fitting.bounces import bounce_models, ratios
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_forms import OtherEstimate

#: restitutions at which a fit of whole trajectories is begun
_STARTS = np.linspace(0.6, 0.97, 12)


def of_drops(drops: Sequence[Impacts], fit: Fit) -> list[OtherEstimate]:
    """Restitutions by other rules than the fit's, each with what is wrong with it.

    Args:
        drops: what was measured.
        fit: the fit of the events.
    """
    found = []
    for number, drop in enumerate(drops, start=1):
        found += _of_times(number, drop)
        if drop.track is not None:
            found.append(_of_trajectory(number, drop, fit))
    return found


def _of_times(number: int, drop: Impacts) -> list[OtherEstimate]:
    """Rules on the times between impacts; the ones that text books give."""
    try:
        best = ratios.ratios(drop)
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


def _of_trajectory(number: int, drop: Impacts, fit: Fit) -> OtherEstimate:
    """Least squares of height against time, from many starts."""
    from scipy.optimize import least_squares

    assert drop.track is not None
    track, problem = drop.track, fit.problem
    values = dict(problem.values(fit.x, number - 1))
    best = [float(values[n]) for n in ("drop_height_m", "release_time_s", "floor_m")]

    def residuals(x: Array) -> Array:
        trial = {**values, "restitution": np.asarray(x[0]), "drop_height_m": np.asarray(x[1]),
                 "release_time_s": np.asarray(x[2]), "floor_m": np.asarray(x[3])}  # fmt: skip
        shown = bounce_models.bounces(problem.model, trial, drop.count)
        flight = np.searchsorted(shown.impact_s, track.time_s)
        height = bounce_models.height_at(shown, trial, track.time_s, np.minimum(flight, drop.count))
        return np.asarray(height - track.height_m, dtype=float)

    low = [0.05, 0.2 * best[0], best[1] - 0.5, best[2] - 0.5]
    high = [0.99, 3 * best[0], best[1] + 0.5, best[2] + 0.5]
    ends = [
        least_squares(residuals, [start, *best], bounds=(low, high), max_nfev=80)
        for start in _STARTS
    ]
    winner = min(ends, key=lambda end: end.cost)
    reached = int(sum(end.cost < 1.01 * winner.cost for end in ends))
    return OtherEstimate(
        drop=number, source=drop.source, rule="trajectory", value=float(winner.x[0]), u=None,
        starts=len(ends), reached=reached,
    )  # fmt: skip
