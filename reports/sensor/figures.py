"""Pictures of a data sheet: the share of each term, and what drawn devices read."""

from __future__ import annotations

import numpy as np

from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Bars, Figure, Panel
from simcompare.reports.sensor import words
from simcompare.results.records.sensor import SensorReading

_BLUE = "#0072B2"
#: bars that have room for their own number
_ROOM = 12.0


def shares(found: SensorReading) -> Figure:
    """How much of the variance each term does."""
    rows = found.shares
    parts = np.array([100 * (row.share or 0.0) for row in rows])
    texts = tuple(f"{numbers.plain(part, 2)} %" if part > _ROOM else "" for part in parts.tolist())
    ticks = tuple(f"{row.title}\n{words.told(row.contribution or 0.0, found.unit)}" for row in rows)
    panel = Panel(
        "", "Share of the variance of a reading (%)", "", (),
        bars=(Bars("share of the variance", parts, _BLUE, "", texts),), y_ticks=ticks,
    )  # fmt: skip
    chip = f"{found.chip}, {found.part.replace('_', ' ')}"
    return Figure(
        "shares",
        f"What makes a reading of {found.reading_text} uncertain: {chip}",
        "Variances add, so the shares sum to 100 %. What is smaller than a tenth of the largest"
        " standard uncertainty does less than 1 % of the work.",
        (panel,),
        height=round(max(0.6, len(rows) / 7), 2),
    )
