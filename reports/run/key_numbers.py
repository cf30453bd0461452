"""The few numbers that a run begins with: the leading measure at each contact level."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from simcompare.comparison.comparison import FAIL, PASS
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.reports.render.parts import KeyNumber
from simcompare.reports.run import runs
from simcompare.reports.run.lead import MIXED, NOTHING, WITHIN, Lead, Row, lead_of
from simcompare.reports.run.lead_rows import rows_of
from simcompare.reports.run.listing import in_how_many, noun
from simcompare.reports.run.misses import fate, misses_of
from simcompare.reports.run.templates import template_of
from simcompare.results.run import Run


def key_numbers(run: Run) -> tuple[KeyNumber, ...]:
    """One for each contact level at which an engine ran, and the truth."""
    lead = lead_of(run)
    if lead is None:
        return ()
    levels = [(mode, rows_of(run, lead, mode)) for mode in runs.modes(run)]
    numbers = [_of_level(run, lead, mode, rows) for mode, rows in levels if rows]
    if lead.truth is not None:
        numbers.append(KeyNumber("truth", lead.true))
    return tuple(numbers)


def _of_level(run: Run, lead: Lead, mode: str, rows: Sequence[Row]) -> KeyNumber:
    label, names = runs.mode_words(mode), [row.name for row in rows]
    known = [replace(row, scatter=None) for row in rows if row.value is not None]
    still = [row.name for row in rows if row.kind == NOTHING]
    if still and len(still) == len(known):
        note = f"{template_of(lead, NOTHING)} {in_how_many(still, names)}"
        # a value next to nothing is none
        return KeyNumber(label, lead.none, note, _verdict(run, mode, names))
    ends = [end for row in rows if row.kind == MIXED for end in row.ends or ()]
    known += [Row("", end, None, MIXED) for end in ends]
    note = _note(run, lead, mode, rows)
    return KeyNumber(label, lead.range_of(known), note, _verdict(run, mode, names))


def _note(run: Run, lead: Lead, mode: str, rows: Sequence[Row]) -> str:
    """In how many engines the value is right, and how many other values are not."""
    names = [row.name for row in rows]
    note = _count(run, lead, rows)
    misses = [] if mode in SHOWN_LEVELS else misses_of(run, lead, mode, names)
    if not misses:
        return note
    several = len(misses) > 1
    others = f"{len(misses)} other value{'s' if several else ''}"
    return f"{note}; {others} {fate(misses, several=several)}"


def _count(run: Run, lead: Lead, rows: Sequence[Row]) -> str:
    """In how many engines the value is right, or known where it is not judged."""
    if lead.is_judged:
        within = sum(row.kind == WITHIN for row in rows)
        return f"{within} of {len(rows)} within ±{lead.accepted}{lead.after}"
    known = sum(row.value is not None for row in rows)
    names = [row.name for row in rows]
    return "not judged" if runs.beyond(run) else f"{known} of {len(rows)} {noun(names)}"


def _verdict(run: Run, mode: str, names: Sequence[str]) -> str:
    """Whether everything that is judged at a level is right."""
    scores = [runs.score_of(run, name, mode, m) for name in names for m in runs.judged(run)]
    verdicts = {score.verdict for score in scores if score is not None}
    if mode in SHOWN_LEVELS:
        return ""
    return FAIL if FAIL in verdicts else PASS if PASS in verdicts else ""
