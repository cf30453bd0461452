"""What a run or a fit has found, in the language of the page."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.lab.translation import GERMAN, each, filled, translated
from simcompare.model.settings import ASSISTED, BY_HAND, COEFFICIENTS, DEFAULT, TUNED
from simcompare.reports.fit import fits
from simcompare.reports.fit.short import able
from simcompare.reports.fit.short import short as short_of_fit
from simcompare.reports.run import runs, short
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
from simcompare.reports.run.lead_rows import rows_of
from simcompare.results.fit_file import FITTED
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.run import Run

#: how a sentence about a level begins
_HEADS = {
    DEFAULT: "As they come", COEFFICIENTS: "With coefficients alone", TUNED: "Tuned",
    ASSISTED: "With our helps", BY_HAND: "Set by hand", FITTED: "Fitted",
}  # fmt: skip
#: what is said of sources of a kind
_CLAUSES = {
    WITHIN: "{value} in {engines}, as it should be",
    UNJUDGED: "{value} in {engines}",
    OUTSIDE: "{value} instead of {true} in {engines}",
    NOTHING: "{value} instead of {true} in {engines}",
    MIXED: "not the same in every repeat in {engines}",
    UNMEASURED: "not measurable in {engines}",
}
#: more engines than these are counted
_NAMED = 3


def of_run(result: Run, language: str) -> str:
    """The answer of a run: in English that of its report, else one sentence for each level."""
    if language != GERMAN:
        return " ".join(short.short(result))
    lead, first = lead_of(result), each(runs.beyond(result), language)
    if lead is None:
        return " ".join([*first, translated("Nothing was measured.", language)])
    told = [_of_level(result, lead, level, language) for level in runs.modes(result)]
    return " ".join([*first, *filter(None, told)])


def of_fit(result: Run, found: BouncesFit, language: str) -> str:
    """The answer of a fit."""
    if language != GERMAN:
        return " ".join(short_of_fit(result))
    said = []
    if fits.RESTITUTION in found.closed_form.parameters:
        value = _number(fits.restitution_of_first(found)[1], language)
        said.append(filled("The ball's restitution is {value} (95 %).", language, value=value))
    good, every = able(found.sources), [row.name for row in found.sources]
    if not good:
        return " ".join([*said, translated("No engine could be fitted.", language)])
    engines = _engines(good, every, language)
    return " ".join([*said, filled("Fitted to it: {engines}.", language, engines=engines)])


def _of_level(result: Run, lead: Lead, level: str, language: str) -> str:
    rows = rows_of(result, lead, level)
    kinds = sorted({row.kind for row in rows}, key=[*_CLAUSES].index)
    head = translated(_HEADS.get(level, level), language)
    clauses = [
        _clause(lead, [row for row in rows if row.kind == kind], rows, language) for kind in kinds
    ]
    if not clauses:
        return ""
    return filled(
        "{head}: {measure} {clauses}.", language, head=head,
        measure=translated(lead.words, language), clauses="; ".join(clauses),
    )  # fmt: skip


def _clause(lead: Lead, some: Sequence[Row], every: Sequence[Row], language: str) -> str:
    kind = some[0].kind
    return filled(
        _CLAUSES[kind], language, true=lead.true,
        value=lead.none if kind == NOTHING else _number(lead.range_of(some), language),
        engines=_engines([row.name for row in some], [row.name for row in every], language),
    )  # fmt: skip


def _number(told: str, language: str) -> str:
    """A number or a range of them, as reports write it."""
    low, to, high = told.partition(" to ")
    if to:
        return filled("{low} to {high}", language, low=low, high=high)
    most = told.removeprefix("at most ")
    return told if most == told else filled("at most {value}", language, value=most)


def _engines(some: Sequence[str], every: Sequence[str], language: str) -> str:
    if len(some) > _NAMED and len(some) == len(every):
        return filled("all {count} engines", language, count=len(every))
    if len(some) > _NAMED:
        return filled("{some} of {count} engines", language, some=len(some), count=len(every))
    *most, last = some
    if not most:
        return last
    return filled("{first} and {last}", language, first=", ".join(most), last=last)
