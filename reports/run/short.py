"""The answer of a run in at most 40 words: one short sentence for each contact level."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import groupby

from simcompare.model.answer import VALUE, placeholders
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.reports.run import runs
from simcompare.reports.run.by_step import over_steps
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
from simcompare.reports.run.lead_rows import Group, rows_of
from simcompare.reports.run.level_phrases import head
from simcompare.reports.run.listing import in_how_many, joined, noun
from simcompare.reports.run.misses import misses_of, said
from simcompare.reports.run.templates import filled, template_of
from simcompare.results.run import Run

#: so many words are read before the first figure
MAX_WORDS = 40
#: more engines than this are counted
_NAMED = 2
#: a half sentence that was said, and of what kind
_Said = tuple[str, str]
_NOT_SAID: _Said = ("", "")


@dataclass(frozen=True)
class _Detail:
    """What is told beside what most engines do where they are judged; the first matters most.

    Attributes:
        misses: how many other measures are off, unless most engines are off in the leading one.
        each_step: the values at each of several steps.
        shown_levels: what most engines do where nothing is judged.
        cause: why engines go wrong as they come.
        whole: other measures that the scenario's answer names.
        named: which other measures are missed, and where; else they are counted.
        others: that other engines are off.
        far: the farthest value of the other measures that are missed.
        every_miss: how many other measures are off, also where the leading one is.
        shown_others: that other engines are off where nothing is judged.
        cure: what to do about what goes wrong as engines come.
        judged: the values of the other engines.
        shown: the same where nothing is judged.
    """

    misses: bool = False
    each_step: bool = False
    shown_levels: bool = False
    cause: bool = False
    whole: bool = False
    named: bool = False
    others: bool = False
    far: bool = False
    every_miss: bool = False
    shown_others: bool = False
    cure: bool = False
    judged: bool = False
    shown: bool = False


def short(run: Run) -> tuple[str, ...]:
    """What the run answers, with as much detail as forty words hold."""
    lead, first = lead_of(run), runs.beyond(run)
    if lead is None:
        return (*first, "Nothing was measured.")
    first += lead.lacking
    detail = _Detail()
    best = _told(run, lead, detail)
    for more in fields(_Detail):
        richer = replace(detail, **{more.name: True})
        told = _told(run, lead, richer)
        if _words((*first, *told)) <= MAX_WORDS:
            detail, best = richer, told
    return (*first, *best) or ("Nothing was measured.",)


def _words(sentences: Sequence[str]) -> int:
    return sum(len(sentence.split()) for sentence in sentences)


def _told(run: Run, lead: Lead, detail: _Detail) -> tuple[str, ...]:
    """One sentence for each level, and one for levels at which the same happens."""
    modes = [
        mode
        for mode in runs.modes(run)
        if runs.ran(run, mode) and (detail.shown_levels or mode not in SHOWN_LEVELS)
    ]
    sentences: list[str] = []
    before = _NOT_SAID
    for whole, group in groupby(modes, lambda mode: _level(run, lead, mode, detail, _NOT_SAID)):
        same = list(group)
        text = _level(run, lead, same[0], detail, before) if sentences else whole
        text = text.replace(f" {noun(runs.ran(run, same[0]))}", "") if sentences else text
        sentences.append(f"{head(same, run)} {text}.")
        main = _main(rows_of(run, lead, same[0]))
        before = (_template(lead, same[0], main, detail), main)
    return tuple(sentences)


def _level(run: Run, lead: Lead, mode: str, detail: _Detail, before: _Said) -> str:
    """What happens at a level; a half sentence that was said before is not said again."""
    rows = rows_of(run, lead, mode)
    is_shown, main = mode in SHOWN_LEVELS, _main(rows)
    alike = {row.kind for row in rows} in ({WITHIN}, {UNMEASURED})
    if runs.steps(run) and not is_shown and not alike:
        is_first = f"{{{VALUE}}}" not in before[0]
        told = over_steps(run, lead, rows, each=detail.each_step, first=is_first)
        return "; ".join([told, *_missed(run, lead, mode, detail, rows)])
    parts = [_majority(run, lead, mode, rows, _template(lead, mode, main, detail), before)]
    if detail.shown_others if is_shown else detail.others:
        values = detail.shown if is_shown else detail.judged
        parts += _others(lead, rows, main, values=values)
    if is_shown:
        return _with_cause(run, lead, mode, rows, "; ".join(parts), detail)
    return "; ".join([*parts, *_missed(run, lead, mode, detail, rows)])


def _missed(run: Run, lead: Lead, mode: str, detail: _Detail, rows: Sequence[Row]) -> Iterator[str]:
    """What else is off in any engine."""
    every = [row.name for row in rows]
    is_off = _main(rows) in (OUTSIDE, NOTHING)
    is_told = detail.every_miss if is_off else detail.misses
    misses = misses_of(run, lead, mode, every) if is_told else []
    if misses:
        yield said(run, misses, every, named=detail.named, value=detail.far)


def _with_cause(
    run: Run, lead: Lead, mode: str, rows: Sequence[Row], text: str, detail: _Detail
) -> str:
    """What happens as engines come, and the cause of most of what is wrong."""
    wrong = [row.name for row in rows if row.kind in (OUTSIDE, NOTHING, UNMEASURED)]
    found = causes(run, lead, mode, wrong) if detail.cause else []
    if not found:
        return text
    most = max(found, key=lambda cause: len(cause.names))
    # most engines are right: it must be said of which the cause is
    of = [] if _main(rows) == WITHIN else wrong
    return f"{text}{'; ' if of != wrong else ': '}{most.text(of, cure=detail.cure, named=_NAMED)}"


def _main(rows: Sequence[Row]) -> str:
    """What most engines do."""
    order = (WITHIN, UNJUDGED, OUTSIDE, NOTHING, MIXED, UNMEASURED)
    return max(order, key=lambda kind: sum(row.kind == kind for row in rows))


def _template(lead: Lead, mode: str, kind: str, detail: _Detail) -> str:
    """The half sentence of a kind; that of the leading measure alone where less is told."""
    said = template_of(lead, kind)
    if (
        kind == WITHIN
        and (mode in SHOWN_LEVELS or not detail.whole)
        and VALUE in placeholders(said)
    ):
        return template_of(lead, OUTSIDE)
    return said


def _majority(
    run: Run, lead: Lead, mode: str, rows: Sequence[Row], template: str, before: _Said
) -> str:
    kind = _main(rows)
    most = [replace(row, scatter=None) for row in rows if row.kind == kind]
    where = in_how_many([row.name for row in most], [row.name for row in rows])
    if kind == MIXED:
        return f"the {lead.words} differs from repeat to repeat {where}"
    new = _beyond_what_was_said(template, before[0])
    value = filled(run, lead, mode, new, Group(tuple(most)))
    is_new = (template, kind) != before
    return f"{value}{_instead(lead) if kind == OUTSIDE and is_new else ''} {where}"


def _instead(lead: Lead) -> str:
    """Beside what a value is off: the truth, of an error what is accepted, if none says it."""
    if lead.truth:
        return f" instead of {lead.true}"
    is_said = lead.answer is not None or not lead.is_judged
    return "" if is_said else f" (tolerance {lead.accepted}{lead.after})"


def _beyond_what_was_said(template: str, before: str) -> str:
    """A half sentence from its value on, or the value alone, where the rest was just said."""
    value = f"{{{VALUE}}}"
    if template == before:
        return value if value in template else template
    is_longer = before.endswith(value) and template.startswith(before)
    return template.removeprefix(before.removesuffix(value)) if is_longer else template


def _others(lead: Lead, rows: Sequence[Row], main: str, *, values: bool) -> Iterator[str]:
    """What the engines do that do not do what most do."""
    for kind in (WITHIN, OUTSIDE, NOTHING, MIXED, UNMEASURED):
        some = [replace(row, scatter=None) for row in rows if row.kind == kind != main]
        if some:
            names = [row.name for row in some]
            who = joined(names) if len(names) <= _NAMED else f"{len(names)} others"
            yield _other(lead, kind, some, who, values=values)


def _other(lead: Lead, kind: str, rows: Sequence[Row], who: str, *, values: bool) -> str:
    if kind == WITHIN:
        return f"right in {who}"
    if kind == NOTHING:
        return f"{template_of(lead, kind)} in {who}"
    if kind == UNMEASURED:
        return f"not measurable in {who}"
    ends = [end for row in rows for end in row.ends or () if kind == MIXED]
    told = lead.range_of(rows) if kind == OUTSIDE else lead.span(ends)
    text = "off" if kind == OUTSIDE else "varying"
    return f"{text} in {who} ({told})" if values else f"{text} in {who}"
