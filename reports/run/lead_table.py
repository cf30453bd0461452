"""The leading measure of every source and level as one small table, for the terminal."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence

from simcompare import notation
from simcompare.comparison.comparison import FAIL, PASS, Score
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import AT, TRUTH
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.render.text_tables import lines
from simcompare.reports.run import by_step, runs, settings
from simcompare.reports.run.lead import Lead, lead_as, lead_of
from simcompare.results.run import Run
from simcompare.running.jobs import OK

#: digits of a value with a power of ten, and further ones that show what is outside
_FEW, _MORE = 4, 2
#: a standard deviation in the last digits, after a number
_BRACKETS = re.compile(r"\d\(\d+\)")
_DASH = re.compile("–( |$)")
#: a value that only some of the repeats gave
_SOME = re.compile(r"\(\d+ of \d+\)")
#: a whole number with decimals
_WHOLE = re.compile(r"−?\d+\.0+")
#: what rounding leaves of a part of a tolerance
_EQUAL = 1e-9
_VERDICTS = {PASS: " pass", FAIL: " fail"}


def lead_table(
    run: Run, measure: str | None = None, marks: Mapping[str, str] = _VERDICTS
) -> Table | None:
    """Sources as rows, levels as columns, the truth below; ``None`` where nothing was asked for.

    Args:
        run: the run.
        measure: what is shown; the leading measure where ``None``.
        marks: what stands behind a value that was judged.
    """
    lead = lead_of(run) if measure is None else lead_as(run, measure)
    modes = runs.modes(run)
    if not modes:
        return None
    # a judged value is followed by its verdict
    columns = [Column(mode, text=mode not in SHOWN_LEVELS, nowrap=True) for mode in modes]
    rows = [
        (name, *(cell(run, lead, name, mode, marks) for mode in modes)) for name in runs.names(run)
    ]
    if lead is not None:
        rows += [(name, *(true for _ in modes)) for name, true in _truths(run, lead).items()]
    note = "" if lead is None else _zero(run, lead, rows)
    heads = (Column("engine", text=True), *columns)
    step = settings.step_taken(run) if measure is None and not runs.steps(run) else ""
    return Table(_title(run, lead, step), heads, (Group("", tuple(rows)),), note)


def legend_words(tables: Sequence[Table]) -> list[str]:
    """What of these tables a reader may look up in the glossary: levels and signs."""
    levels = [column.head for table in tables for column in table.columns[1:]]
    cells = [c for table in tables for group in table.groups for row in group.rows for c in row]
    signs = {
        "brackets": any(map(_BRACKETS.search, cells)),
        "8 of 9": any(map(_SOME.search, cells)),
        "–": any(map(_DASH.match, cells)),
    }
    return [*dict.fromkeys(levels), *(sign for sign, is_there in signs.items() if is_there)]


def _zero(run: Run, lead: Lead, rows: Sequence[Sequence[str]]) -> str:
    """What a 0 of the table means, where it is one by rounding."""
    is_there = any(cell.split()[:1] == ["0"] for row in rows for cell in row[1:])
    scores = [s for s in run.record.scores if s.measure == lead.measure and s.index is None]
    values = [one for s in scores for one in (s.value, s.low, s.high) if one]
    decimals = lead.decimals
    if decimals is None or not is_there:
        return ""
    if not any(notation.is_zero(value, decimals) for value in values):
        return ""
    return f"0 means less than {notation.fixed(0.5 * 10.0**-decimals, decimals + 1)}."


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
    """A table with its title above it and its note below."""
    yield from textwrap.wrap(table.title, width)
    yield from lines(table, width)
    yield from textwrap.wrap(table.note, width)


def _title(run: Run, lead: Lead | None, step: str) -> str:
    if lead is None:
        return ""
    unit = "" if lead.unit in ("", "1") else f" in {lead.unit}"
    mean = mean_words(lead, [run.record.repeats])
    accepted = "" if lead.width is None else f"; tolerance {by_step.tolerances(run, lead)}"
    if runs.beyond(run):
        accepted = "; not judged, for the truth does not hold here"
    return f"{lead.words}{unit}{mean}{f', {step}' if step else ''}{accepted}"


def mean_words(lead: Lead, repeats: Sequence[int]) -> str:
    """Of what a value is the mean, behind a comma; empty for a single one."""
    means = ["all events"] if lead.of_events else []
    if max(repeats) > 1:
        means.append(f"{' or '.join(dict.fromkeys(map(str, repeats)))} repeats")
    return f", mean of {' and '.join(means)}" if means else ""


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
    verdict = marks.get(score.verdict, "")
    if score.value is None and score.low is not None and score.high is not None:
        # a mean over some of the repeats would be none over all
        ends = dict.fromkeys(number(lead, end, None) for end in (score.low, score.high))
        return f"{' to '.join(ends)} {runs.measured_words(run, score)}{verdict}"
    return number(lead, score.value, score.scatter, _further(lead, score)) + verdict


def _further(lead: Lead, score: Score) -> int:
    """Further decimals that show that a value is outside, where it is."""
    known = score.value is not None and score.truth is not None and score.tolerance is not None
    if lead.decimals is None or score.verdict != FAIL or not known:
        return 0
    value, truth, width = score.value or 0.0, score.truth or 0.0, score.tolerance or 0.0
    places = range(lead.decimals, lead.decimals + _MORE)
    shown = [abs(round(value, place) - truth) > width * (1 + _EQUAL) for place in places]
    return shown.index(True) if True in shown else _MORE


def number(lead: Lead, value: float | None, u: float | None, further: int = 0) -> str:
    """A value in the concise notation; with a power of ten where that reads better.

    Args:
        lead: the measure.
        value: of it.
        u: its standard deviation.
        further: decimals beyond those that its tolerance leaves.
    """
    decimals = None if lead.decimals is None else lead.decimals + further
    if decimals is not None and decimals > numbers.MOST_PLACES:
        return numbers.with_u(value, u, digits=_FEW)
    text = notation.number(value, u, decimals)
    return text if lead.width or not _WHOLE.fullmatch(text) else text.partition(".")[0]
