"""Scores of single events, and other rows, as arrays that can be drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare.comparison.comparison import Score
from simcompare.model.trajectory import Array
from simcompare.reports.run import runs
from simcompare.reports.run.listing import grouped
from simcompare.results.run import Run


def events_of(run: Run, measure: str) -> dict[tuple[str, str], list[Score]]:
    """Scores of one measure by source and mode, in the order of the events."""
    scores = [s for s in run.record.scores if s.measure == measure and s.index is not None]
    scores.sort(key=lambda score: score.index or 0)
    return grouped(((score.source, score.contact), score) for score in scores)


def column(rows: Sequence[object], field: str) -> Array:
    """One field of some rows (n,); NaN where there is none."""
    values = [getattr(row, field) for row in rows]
    return np.array([np.nan if value is None else float(value) for value in values])


def deviation_scale(reference: Array, *, relative: bool) -> Array:
    """Factors that turn deviations from a reference into per cent of it, or leave them (n,)."""
    return 100 / np.abs(reference) if relative else np.ones(len(reference))


def deviation_unit(unit: str, *, relative: bool) -> str:
    """The unit of such deviations, in brackets."""
    return " (%)" if relative else runs.unit_words(unit)
