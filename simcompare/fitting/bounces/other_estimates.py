"""What one would have concluded with another rule on the times between impacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from simcompare.errors import InputError
from simcompare.fitting.bounces import ratios
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.results.records.fit_forms import OtherEstimate


def of_drops(drops: Sequence[Impacts]) -> list[OtherEstimate]:
    """Restitutions by other rules than the fit's; the ones that text books give."""
    return [row for number, drop in enumerate(drops, start=1) for row in _of_drop(number, drop)]


def _of_drop(number: int, drop: Impacts) -> list[OtherEstimate]:
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
