"""Scores of single events, such as every bounce."""

from __future__ import annotations

from typing import Any

from simcompare.reports.run import runs, score_figures
from simcompare.reports.sections.base import Section
from simcompare.results.run import Run


class Events(Section):
    """Every event with its uncertainty."""

    name, title, template = "events", "Event by event", "events.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """A figure and a table for each measure; ``None`` where nothing was measured per event."""
        measures = score_figures.event_measures(run)
        if not measures:
            return None
        figures = [score_figures.events_figure(run, measure) for measure in measures]
        return {
            "figures": figures,
            "tables": [_table(run, measure) for measure in measures],
            "repeats": run.record.repeats,
        }


def _table(run: Run, measure: str) -> dict[str, Any]:
    rows = score_figures.events_of(run, measure)
    longest = max(rows.values(), key=len)
    count = len(longest)
    return {
        "title": runs.measure_words(measure) + runs.unit_words(longest[0].unit),
        "columns": [f"{name}, {runs.mode_words(mode)}" for name, mode in rows],
        "rows": [
            [
                str(k + 1),
                *(runs.value_words(run, r[k] if k < len(r) else None) for r in rows.values()),
            ]
            for k in range(count)
        ],
    }
