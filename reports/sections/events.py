"""Scores of single events, such as every bounce."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from simcompare.comparison.comparison import Score
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.run import event_figures, runs
from simcompare.reports.run.event_values import events_of
from simcompare.reports.run.listing import grouped, joined
from simcompare.reports.sections.pictures import others
from simcompare.results.run import Run

#: more columns than these are not read beside each other
_BESIDE = 8


def events(run: Run) -> Part | None:
    """A figure and a table for each measure; ``None`` where nothing was measured per event."""
    measures = event_figures.event_measures(run)
    if not measures:
        return None
    first, *rest = (event_figures.events_figure(run, measure) for measure in measures)
    words = ", ".join(map(runs.measure_words, measures[1:]))
    tables = tuple(table for measure in measures for table in _tables(run, measure))
    numbers = Part("The numbers", notes=(_note(run),), tables=tables, folded=True, brief=False)
    finding = f"each {joined([runs.measure_words(measure) for measure in measures])}"
    return Part("Event by event", "events", figures=(first,), folded=True, finding=finding,
                parts=(*others(words, tuple(rest)), numbers))  # fmt: skip


def _note(run: Run) -> str:
    repeats = run.record.repeats
    known = (
        f"Mean ± standard deviation of {repeats} repeats."
        if repeats > 1
        else "A single repeat: no uncertainty is known."
    )
    return f"{known} A dash: the engine does not resolve this event in every repeat."


def _tables(run: Run, measure: str) -> list[Table]:
    """All sources beside each other; one table for each level where that is too wide to read."""
    scores, title = events_of(run, measure), runs.label(measure, _unit(run, measure))
    if len(scores) <= _BESIDE:
        return [_table(run, title, scores)]
    by_mode = grouped((mode, (name, mode)) for name, mode in scores)
    return [
        _table(run, f"{title}, {runs.mode_words(mode)}", {key: scores[key] for key in keys})
        for mode, keys in by_mode.items()
    ]


def _unit(run: Run, measure: str) -> str:
    return next(score.unit for score in run.record.scores if score.measure == measure)


def _table(run: Run, title: str, scores: Mapping[tuple[str, str], Sequence[Score]]) -> Table:
    several = len({mode for _, mode in scores}) > 1
    words = [f"{name}, {runs.mode_words(mode)}" if several else name for name, mode in scores]
    known = [score for row in scores.values() for score in row]
    # one value may be far beyond all others, and a truth is not
    truths: list[float | None] = [score.truth for score in known if score.truth]
    sizes = truths or [score.value for score in known]
    rows = [
        (
            str(k + 1),
            *(
                runs.value_words(run, row[k] if k < len(row) else None, sizes)
                for row in scores.values()
            ),
        )
        for k in range(max(map(len, scores.values())))
    ]
    columns = (Column("Event", text=True), *map(Column, words))
    return Table(title, columns, (Group("", tuple(rows)),))
