"""Half a sentence of a scenario's answer, filled with what engines have."""

from __future__ import annotations

from dataclasses import replace

from simcompare.model.answer import VALUE, placeholders
from simcompare.reports.run import runs
from simcompare.reports.run.lead import NOTHING, OUTSIDE, UNJUDGED, UNMEASURED, Lead, lead_as
from simcompare.reports.run.lead_rows import Group, rows_of
from simcompare.results.run import Run


def template_of(lead: Lead, kind: str) -> str:
    """What is said where the leading measure is of a kind: within, outside, nothing, and so on."""
    if kind == UNMEASURED:
        return f"the {lead.words} could not be measured"
    kind = OUTSIDE if kind == UNJUDGED else kind
    said = lead.answer.half_sentence(kind) if lead.answer is not None else None
    if said is None:
        none = kind == NOTHING
        return f"there is no {lead.words}" if none else f"the {lead.words} is {{{VALUE}}}"
    return said


def filled(run: Run, lead: Lead, mode: str, template: str, group: Group) -> str:
    """A template with the values of some engines that agree."""
    values = {VALUE: lead.range_of(group.rows)}
    measured = set(runs.measures(run))
    for name in placeholders(template):
        if name != VALUE:
            values[name] = _other(run, name, mode, group) if name in measured else "–"
    return template.format(**values)


def _other(run: Run, measure: str, mode: str, group: Group) -> str:
    """What the same engines have of another measure, which is not judged here."""
    lead = lead_as(run, measure)
    rows = [row for row in rows_of(run, lead, mode) if row.name in group.names]
    return lead.range_of([replace(row, scatter=None, kind=UNJUDGED) for row in rows])
