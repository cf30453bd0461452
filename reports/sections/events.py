"""Scores of single events, such as every bounce."""

from __future__ import annotations

from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.run import event_figures, runs
from simcompare.reports.run.event_values import events_of
from simcompare.reports.sections.pictures import others
from simcompare.results.run import Run


def events(run: Run) -> Part | None:
    """A figure and a table for each measure; ``None`` where nothing was measured per event."""
    measures = event_figures.event_measures(run)
    if not measures:
        return None
    first, *rest = (event_figures.events_figure(run, measure) for measure in measures)
    words = ", ".join(map(runs.measure_words, measures[1:]))
    tables = tuple(_table(run, measure) for measure in measures)
    numbers = Part("The numbers", notes=(_note(run),), tables=tables, folded=True, brief=False)
    return Part("Event by event", "events", figures=(first,),
                parts=(*others(words, tuple(rest)), numbers))  # fmt: skip


def _note(run: Run) -> str:
    repeats = run.record.repeats
    known = (
        f"Mean ± standard deviation of {repeats} repeats."
        if repeats > 1
        else "A single repeat: no uncertainty is known."
    )
    return f"{known} A dash: the engine does not resolve this event in every repeat."


def _table(run: Run, measure: str) -> Table:
    scores = events_of(run, measure)
    longest = max(scores.values(), key=len)
    columns = [Column(f"{name}, {runs.mode_words(mode)}") for name, mode in scores]
    rows = [
        (
            str(k + 1),
            *(runs.value_words(run, row[k] if k < len(row) else None) for row in scores.values()),
        )
        for k in range(len(longest))
    ]
    title = runs.label(measure, longest[0].unit)
    return Table(title, (Column("Event", text=True), *columns), (Group("", tuple(rows)),))
