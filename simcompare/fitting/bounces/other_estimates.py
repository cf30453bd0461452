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

#: restitutions at which a fit of whole trajectories is begun
_STARTS = np.linspace(0.6, 0.97, 12)


def of_drops(drops: Sequence[Impacts], fit: Fit) -> list[dict[str, Any]]:
    """Restitutions by other rules than the fit's, each with what is wrong with it.

    Args:
        drops: what was measured.
        fit: the fit of the events.
    """
    found = []
    for number, drop in enumerate(drops, start=1):
        rows = _of_times(drop)
        if drop.track is not None:
            rows.append(_of_trajectory(drop, fit, number - 1))
        found += [{"drop": number, "source": drop.source, **row} for row in rows]
    return found


def _of_times(drop: Impacts) -> list[dict[str, Any]]:
    """Rules on the times between impacts; the ones that text books give."""
    try:
        best = ratios.ratios(drop)
    except InputError:
        return []
    rows = [
        _row("mean ratio of neighbouring flights, weighted", best.mean, best.u_mean,
             f"no height and no clock matters; drag biases it. {best.text}"),
        _row("first ratio alone", float(best.values[0]), _finite(best.u[0]), "one bounce only"),
    ]  # fmt: skip
    numbers = np.array(drop.numbers)
    steps = np.diff(drop.times_s)[np.diff(numbers) == 1]
    at = numbers[:-1][np.diff(numbers) == 1]
    if len(steps) > 2:
        slope = float(np.polyfit(at, np.log(steps), 1)[0])
        text = "every flight counts alike, long and short ones"
        rows.append(_row("line through the logarithms of the flights", np.exp(slope), None, text))
    return rows


def _of_trajectory(drop: Impacts, fit: Fit, number: int) -> dict[str, Any]:
    """Least squares of height against time, from many starts."""
    from scipy.optimize import least_squares

    assert drop.track is not None
    track, problem = drop.track, fit.problem
    values = dict(problem.values(fit.x, number))
    best = [float(values[n]) for n in ("drop_height_m", "release_time_s", "floor_m")]

    def left(x: Array) -> Array:
        asked = {**values, "restitution": np.asarray(x[0]), "drop_height_m": np.asarray(x[1]),
                 "release_time_s": np.asarray(x[2]), "floor_m": np.asarray(x[3])}  # fmt: skip
        shown = bounce_models.bounces(problem.model, asked, drop.count)
        flight = np.searchsorted(shown.impact_s, track.time_s)
        seen = bounce_models.height_at(shown, asked, track.time_s, np.minimum(flight, drop.count))
        return np.asarray(seen - track.height_m, dtype=float)

    low = [0.05, 0.2 * best[0], best[1] - 0.5, best[2] - 0.5]
    high = [0.99, 3 * best[0], best[1] + 0.5, best[2] + 0.5]
    ends = [
        least_squares(left, [start, *best], bounds=(low, high), max_nfev=80) for start in _STARTS
    ]
    winner = min(ends, key=lambda end: end.cost)
    reached = sum(end.cost < 1.01 * winner.cost for end in ends)
    return _row(
        "least squares of the whole trajectory", float(winner.x[0]), None,
        f"residuals jump where impacts move: {reached} of {len(ends)} starts reached the minimum",
    )  # fmt: skip


def _row(name: str, value: float, u: float | None, text: str) -> dict[str, Any]:
    return {"name": name, "value": float(value), "u": u, "text": text}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
