"""The leading measure of every source and level as one small table, for the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping

from simcompare import notation
from simcompare.comparison.comparison import FAIL, PASS
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import AT, TRUTH
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.render.text_tables import lines
from simcompare.reports.run import by_step, runs
from simcompare.reports.run.lead import Lead, lead_as, lead_of
from simcompare.results.run import Run
from simcompare.running.jobs import OK

#: further digits than the tolerance leaves
_MORE = 2
_VERDICTS = {PASS: " pass", FAIL: " fail"}


def lead_table(run: Run, measure: str | None = None) -> Table | None:
    """Sources as rows, levels as columns, the truth below; ``None`` where nothing was asked for.

    Args:
        run: the run.
        measure: what is shown; the leading measure where ``None``.
    """
    lead = lead_of(run) if measure is None else lead_as(run, measure)
    modes = runs.modes(run)
    if not modes:
        return None
    # a judged value is followed by its verdict
    columns = [Column(mode, text=mode not in SHOWN_LEVELS, nowrap=True) for mode in modes]
    rows = [(name, *(cell(run, lead, name, mode) for mode in modes)) for name in runs.names(run)]
    if lead is not None:
        rows += [(name, *(true for _ in modes)) for name, true in _truths(run, lead).items()]
    return Table(
        _title(run, lead), (Column("engine", text=True), *columns), (Group("", tuple(rows)),)
    )


def _truths(run: Run, lead: Lead) -> dict[str, str]:
    """The truth as a row; one for each step where they differ in what is shown."""
    truths = {
        score.source.partition(AT)[2]: number(lead, score.truth, None)
        for score in run.record.scores
        if score.measure == lead.measure and score.index is None and score.truth is not None
    }
    if len(set(truths.values())) < 2:
        return dict.fromkeys([TRUTH] if truths else [], next(iter(truths.values()), ""))
    return {f"{TRUTH}{AT}{step}": true for step, true in truths.items()}


def lead_tables(run: Run, *, every: bool) -> list[Table]:
    """The table of the leading measure, and those of all others where they are wanted."""
    lead = lead_of(run)
    others = [name for name in runs.measures(run) if lead and name != lead.measure]
    made = [lead_table(run), *(lead_table(run, name) for name in others if every)]
    return [table for table in made if table is not None]


def text(table: Table, width: int) -> Iterator[str]:
    """A table with its title above it."""
    yield from textwrap.wrap(table.title, width)
    yield from lines(table, width)


def _title(run: Run, lead: Lead | None) -> str:
    if lead is None:
        return ""
    unit = "" if lead.unit in ("", "1") else f" in {lead.unit}"
    title = f"{lead.words}{unit}"
    means = ["all events of a repeat"] if lead.of_events else []
    if run.record.repeats > 1:
        means.append(f"{run.record.repeats} repeats (scatter in the last digits)")
    if means:
        title += f", mean over {' and '.join(means)}"
    if runs.beyond(run):
        return f"{title}; not judged, for the truth does not hold here"
    return title if lead.width is None else f"{title}; tolerance {_tolerances(run, lead)}"


def _tolerances(run: Run, lead: Lead) -> str:
    """Half-width of what is accepted; of several steps that of each."""
    each = by_step.widths(run, lead)
    if len({numbers.plain(width, 2) for _, width in each if width is not None}) < 2:
        return lead.accepted
    return ", ".join(f"{numbers.plain(w, 2)} at {step}" for step, w in each if w is not None)


def cell(
    run: Run, lead: Lead | None, name: str, mode: str, marks: Mapping[str, str] = _VERDICTS
) -> str:
    """What a source has of a measure at a level, with its scatter and verdict.

    Args:
        run: the run.
        lead: the measure.
        name: of the source.
        mode: the level.
        marks: what stands behind a value that was judged.
    """
    source = runs.source_of(run, name, mode)
    if source is None:
        return "–"
    if source.status != OK:
        return str(source.status)
    score = runs.score_of(run, name, mode, lead.measure) if lead else None
    if lead is None or score is None:
        return "–"
    if score.value is None and score.low is not None and score.high is not None:
        # a mean over some of the repeats would be none over all
        ends = " to ".join(
            dict.fromkeys(number(lead, end, None) for end in (score.low, score.high))
        )
        return f"{ends} {runs.measured_words(run, score)}{marks.get(score.verdict, '')}"
    return number(lead, score.value, score.scatter) + marks.get(score.verdict, "")


def number(lead: Lead, value: float | None, u: float | None) -> str:
    """A value in the concise notation, to a hundredth of the tolerance at most."""
    if value is None:
        return "–"
    places = lead.places(value)
    if places is None:
        text = notation.number(value, u)
        return f"−{text[1:]}" if text.startswith("-") else text
    places += _MORE
    digits = round((u or 0.0) * 10**places)
    if digits >= 100:  # two digits of the scatter are enough
        places -= min(len(str(digits)) - 2, places)
        digits = round((u or 0.0) * 10**places)
    text = numbers.fixed(value, places)
    return f"{text}({digits})" if digits else text
