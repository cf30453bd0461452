"""The answer of a run in plain words, written from its record: scores, audit, what is lacking."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

from simcompare.model.answer import VALUE, placeholders
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import TRUTH
from simcompare.reports.render import numbers
from simcompare.reports.run import by_step, listing, runs
from simcompare.reports.run.causes import causes
from simcompare.reports.run.lead import (
    MIXED,
    NOTHING,
    OUTSIDE,
    UNJUDGED,
    UNMEASURED,
    WITHIN,
    Lead,
    Row,
    lead_of,
)
from simcompare.reports.run.lead_rows import Group, groups_of, rows_of
from simcompare.reports.run.level_phrases import merged
from simcompare.reports.run.templates import filled, template_of
from simcompare.results.run import Run

#: so many values are told apart, more of them as a range
_MAX_GROUPS = 2


def sentences(run: Run) -> list[str]:
    """One sentence for each contact level: what it gives, in which engines, beside the truth.

    Where steps are compared, one line for each engine: how the value changes with the step.
    """
    lead, beyond = lead_of(run), [*runs.beyond(run)]
    if lead is None:
        return [*beyond, "Nothing was measured."]
    if runs.steps(run):
        lines = [line for mode in runs.modes(run) for line in by_step.lines(run, lead, mode)]
    else:
        lines = merged(run, ((mode, _level(run, lead, mode)) for mode in runs.modes(run)))
    if beyond:
        lines.append("Nothing is judged: there the truth does not hold.")
    elif lead.truth is None and lines:
        lines.append(f"There is no truth to hold the {lead.words} against.")
    return [*beyond, *lead.lacking, *lines] or ["Nothing was measured."]


def _level(run: Run, lead: Lead, mode: str) -> str:
    rows = rows_of(run, lead, mode)
    if not rows:
        return ""
    clauses = _clauses(run, lead, mode, rows, (WITHIN, UNJUDGED, OUTSIDE, NOTHING))
    if lead.truth and all(row.kind == WITHIN for row in rows):
        clauses += _nearness(lead, rows)
    unknown = _clauses(run, lead, mode, rows, (MIXED, UNMEASURED))
    if mode in SHOWN_LEVELS:
        why = _why(run, lead, mode, rows, (OUTSIDE, NOTHING), cure=True)
        clauses += f": {why}" if why else ""
        why = _why(run, lead, mode, rows, (UNMEASURED,), cure=False)
        unknown += f": {why}" if why else ""
    return "; ".join(part for part in (clauses, unknown) if part)


def _clauses(run: Run, lead: Lead, mode: str, rows: Sequence[Row], kinds: Sequence[str]) -> str:
    """What is within the tolerance, then what is not, and where nothing is."""
    counts = Counter(row.kind for row in rows)
    # what most engines do wrong comes first
    wrong = sorted((OUTSIDE, NOTHING), key=lambda kind: -counts[kind])
    order = (WITHIN, UNJUDGED, *wrong, MIXED, UNMEASURED)
    present = [kind for kind in order if kind in kinds and counts[kind]]
    return "; ".join(_clause(run, lead, mode, rows, kind) for kind in present)


def _clause(run: Run, lead: Lead, mode: str, rows: Sequence[Row], kind: str) -> str:
    """What the sources of one kind have."""
    every, of_kind = [row.name for row in rows], [row for row in rows if row.kind == kind]
    if kind == MIXED:
        ends = ", ".join(_mixed(run, lead, row) for row in of_kind)
        return f"the {lead.words} differs from repeat to repeat, {ends}"
    if kind in (NOTHING, UNMEASURED):
        names = listing.engines([row.name for row in of_kind], every)
        return f"{template_of(lead, kind)} in {names}{_lacking(of_kind)}"
    if kind != OUTSIDE:
        return _values(run, lead, mode, of_kind, every, bare=False)
    repeated = any(row.kind == WITHIN for row in rows)
    values = _values(run, lead, mode, of_kind, every, bare=repeated)
    head = "too far off: " if repeated else ""
    return f"{head}{values}, where the {TRUTH} gives {lead.true}" if lead.truth else head + values


def _values(
    run: Run, lead: Lead, mode: str, rows: Sequence[Row], every: Sequence[str], *, bare: bool
) -> str:
    """Half a sentence, then value by value the engines that agree."""
    template = template_of(lead, rows[0].kind)
    groups = groups_of(lead, rows)
    if VALUE not in placeholders(template):
        groups = [Group(tuple(rows))]
    if len(groups) > _MAX_GROUPS:
        groups = [Group(tuple(sorted(rows, key=lambda row: row.value or 0.0)))]
    parts: list[str] = []
    for group in groups:
        first = not parts and not bare
        value = filled(run, lead, mode, template, group) if first else lead.range_of(group.rows)
        parts.append(f"{value} in {listing.engines(group.names, every)}")
    return ", ".join(parts)


def _mixed(run: Run, lead: Lead, row: Row) -> str:
    """The lowest and highest repeat of a source, and how many there are where some are missing."""
    of = run.record.repeats
    count = "" if row.repeats == of else f" (measured in {row.repeats} of {of})"
    return f"{lead.ends(row)} in {row.name}{count}"


def _lacking(rows: Sequence[Row]) -> str:
    """Why sources give no value, as far as they tell."""
    reasons = dict.fromkeys(row.lacking for row in rows if row.lacking)
    return f" ({'; '.join(reasons)})" if reasons else ""


def _nearness(lead: Lead, rows: Sequence[Row]) -> str:
    """How near all engines come, rounded up."""
    truth = lead.truth or 0.0
    worst = max(abs((row.value or 0.0) - truth) for row in rows)
    unit = "" if lead.unit in ("", "1") else f" {lead.unit}"
    least = max(numbers.ROUNDING * abs(truth), 1e-6 * (lead.width or 0.0))
    near = f"{numbers.plain(_rounded_up(max(worst, least)), 1)}{unit}"
    return f", within {near} of the {TRUTH} of {lead.true}"


def _rounded_up(value: float) -> float:
    """To one digit, never below."""
    if value <= 0:
        return 0.0
    place = 10.0 ** math.floor(math.log10(value))
    return math.ceil(value / place * (1 - 1e-9)) * place


def _why(
    run: Run, lead: Lead, mode: str, rows: Sequence[Row], kinds: Sequence[str], *, cure: bool
) -> str:
    wrong = [row.name for row in rows if row.kind in kinds]
    found = causes(run, lead, mode, wrong)
    return "; ".join(cause.text(wrong, cure=cure) for cause in found)
