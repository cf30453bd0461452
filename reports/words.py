"""The answer of a run in plain words, written from its scores and from nothing else."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from simcompare.answer import VALUE, placeholders
from simcompare.reports import audit, listing, numbers, runs
from simcompare.reports.lead import (
    NOTHING,
    OUTSIDE,
    UNJUDGED,
    WITHIN,
    Group,
    Lead,
    Row,
    groups_of,
    lead_as,
    lead_of,
    rows_of,
)
from simcompare.results import TRUTH, Run
from simcompare.settings import ASSISTED, COEFFICIENTS, DEFAULT, SHOWN_LEVELS, TUNED

#: so many values are told apart, the others as a range
_MOST_GROUPS = 5


def answer(run: Run) -> list[str]:
    """One sentence for each contact level: what it gives, in which engines, beside the truth."""
    lead = lead_of(run)
    if lead is None:
        return ["Nothing was measured."]
    found = merged((how(run, mode), _level(run, lead, mode)) for mode in runs.modes(run))
    if lead.truth is None and found:
        found.append(f"There is no truth to hold the {lead.words} against.")
    return found or ["Nothing was measured."]


def merged(said: Iterable[tuple[str, str]]) -> list[str]:
    """Sentences of a begin and a rest; those after each other with the same rest are one."""
    found: list[str] = []
    for rest, group in itertools.groupby(((head, rest) for head, rest in said if rest), _rest):
        first, *others = (head for head, _ in group)
        also = "".join(f"; {head[0].lower()}{head[1:].rstrip(',')} the same" for head in others)
        found.append(f"{first} {rest}{also}.")
    return found


def _rest(said: tuple[str, str]) -> str:
    return said[1]


def how(run: Run, mode: str) -> str:
    """A level as the begin of a sentence, with the step that all engines took in it."""
    if mode == ASSISTED and run.record.get("assist") == "none":
        return "With none of our helps,"
    if mode == TUNED:
        return f"Tuned{_step(run, mode)},"
    return _HOW.get(mode, f"At the level {mode},")


_HOW = {
    DEFAULT: "By default",
    COEFFICIENTS: "With the coefficients alone,",
    ASSISTED: "With our helps,",
    "fitted": "With the fitted parameters,",
}


def _step(run: Run, mode: str) -> str:
    ran = [run_source for run_source in run.record["sources"] if run_source["contact"] == mode]
    steps = {audit.step_of(source) for source in ran if source["status"] == "ok"}
    step_s = steps.pop() if len(steps) == 1 else None
    return "" if step_s is None else f" at a step of {numbers.plain(1e3 * step_s, 3)} ms"


def _level(run: Run, lead: Lead, mode: str) -> str:
    rows = rows_of(run, lead, mode)
    if not rows:
        return ""
    clauses = _clauses(run, lead, mode, rows)
    if all(row.kind == WITHIN for row in rows):
        clauses += _nearness(lead, rows)
    if mode in SHOWN_LEVELS:
        clauses += _causes(run, lead, mode, rows)
    return clauses


def _clauses(run: Run, lead: Lead, mode: str, rows: Sequence[Row]) -> str:
    """What is within the tolerance, then what is not, and where nothing is."""
    every = [row.name for row in rows]
    said: list[str] = []
    counts = Counter(row.kind for row in rows)
    # what most engines do wrong comes first
    wrong = sorted((OUTSIDE, NOTHING), key=lambda kind: -counts[kind])
    same = _template(lead, WITHIN) == _template(lead, OUTSIDE)
    for kind in (WITHIN, UNJUDGED, *wrong):
        own = [row for row in rows if row.kind == kind]
        if own and kind == NOTHING:
            names = listing.engines([row.name for row in own], every)
            said.append(f"{_template(lead, NOTHING)} in {names}")
        elif own:
            repeated = kind == OUTSIDE and counts[WITHIN] > 0 and same
            values = _values(run, lead, mode, own, every, bare=repeated)
            values = f"outside the tolerance: {values}" if repeated else values
            truth = f", where the {TRUTH} gives {_true(lead)}" if kind == OUTSIDE else ""
            said.append(values + truth)
    return "; ".join(said)


def _values(
    run: Run, lead: Lead, mode: str, rows: Sequence[Row], every: Sequence[str], *, bare: bool
) -> str:
    """Half a sentence, then value by value the engines that agree."""
    template = _template(lead, rows[0].kind)
    groups = groups_of(lead, rows)
    if VALUE not in placeholders(template):
        groups = [Group(tuple(rows))]
    parts: list[str] = []
    for group in groups[:_MOST_GROUPS]:
        first = not parts and not bare
        value = _filled(run, lead, mode, template, group) if first else lead.told(group.row)
        parts.append(f"{value} in {listing.engines(group.names, every)}")
    others = [row for group in groups[_MOST_GROUPS:] for row in group.rows]
    if others:
        others = sorted(others, key=lambda row: row.value or 0.0)
        low, high = (lead.text(others[i].value) for i in (0, -1))
        ends = low if low == high else f"{low} to {high}"
        parts.append(f"{ends} in {listing.joined([row.name for row in others])}")
    return ", ".join(parts)


def _template(lead: Lead, kind: str) -> str:
    kind = OUTSIDE if kind == UNJUDGED else kind
    if lead.answer is not None:
        return str(lead.answer[kind])
    return f"there is no {lead.words}" if kind == NOTHING else f"the {lead.words} is {{{VALUE}}}"


def _filled(run: Run, lead: Lead, mode: str, template: str, group: Group) -> str:
    """A template with the values of some engines that agree."""
    values = {VALUE: lead.told(group.row)}
    measured = {score.measure for score in run.scores if score.index is None}
    for name in placeholders(template):
        if name != VALUE:
            known = [runs.score_of(run, one, mode, name) for one in group.names]
            found = [s.value for s in known if s is not None and s.value is not None]
            mean = sum(found) / len(found) if found else None
            values[name] = lead_as(run, name).text(mean) if name in measured else "–"
    return template.format(**values)


def _nearness(lead: Lead, rows: Sequence[Row]) -> str:
    """How near all engines come, rounded up."""
    truth = lead.truth or 0.0
    worst = max(abs((row.value or 0.0) - truth) for row in rows)
    unit = "" if lead.unit in ("", "1") else f" {lead.unit}"
    least = max(numbers.ROUNDING * abs(truth), 1e-6 * (lead.width or 0.0))
    near = f"{numbers.plain(_rounded_up(max(worst, least)), 1)}{unit}"
    return f", within {near} of the {TRUTH} of {_true(lead)}"


def _rounded_up(value: float) -> float:
    """To one digit, never below."""
    if value <= 0:
        return 0.0
    place = 10.0 ** math.floor(math.log10(value))
    return math.ceil(value / place * (1 - 1e-9)) * place


def _true(lead: Lead) -> str:
    return numbers.plain(lead.truth, 4) + ("" if lead.unit in ("", "1") else f" {lead.unit}")


def _causes(run: Run, lead: Lead, mode: str, rows: Sequence[Row]) -> str:
    """What the scenario names as a cause, where the audit shows that it holds."""
    missing = [row.name for row in rows if row.kind in (OUTSIDE, NOTHING)]
    said = []
    for cause in (lead.answer or {}).get("causes", ()):
        own = [name for name in missing if _keeps(run, name, mode, cause)]
        if own:
            where = "" if own == missing else f"in {listing.joined(own)} "
            said.append(f"{where}{cause['says']}")
    return f": {'; '.join(said)}" if said else ""


def _keeps(run: Run, name: str, mode: str, cause: Mapping[str, Any]) -> bool:
    source = runs.source_of(run, name, mode)
    return source is not None and audit.keeps_its_own(source, cause["quantity"])
