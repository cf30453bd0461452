"""The few numbers that a run begins with: the leading measure at each contact level."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.model.settings import SHOWN_LEVELS
from simcompare.reports.render.parts import KeyNumber
from simcompare.reports.run import runs
from simcompare.reports.run.lead import UNMEASURED, WITHIN, Lead, Row, lead_of
from simcompare.reports.run.lead_rows import rows_of
from simcompare.results.run import Run


def key_numbers(run: Run) -> tuple[KeyNumber, ...]:
    """One for each contact level, and the truth."""
    lead = lead_of(run)
    if lead is None:
        return ()
    numbers = [_of_level(lead, mode, rows_of(run, lead, mode)) for mode in runs.modes(run)]
    if lead.truth is not None:
        numbers.append(KeyNumber("truth", lead.true))
    return tuple(numbers)


def _of_level(lead: Lead, mode: str, rows: Sequence[Row]) -> KeyNumber:
    known = [row for row in rows if row.kind != UNMEASURED]
    label = runs.mode_words(mode)
    if not lead.is_judged:
        return KeyNumber(label, lead.range_of(known), f"{len(known)} of {len(rows)} engines")
    within = sum(row.kind == WITHIN for row in rows)
    note = f"{within} of {len(rows)} within ±{lead.accepted}"
    judged = mode not in SHOWN_LEVELS and bool(rows)
    verdict = ("pass" if within == len(rows) else "fail") if judged else ""
    return KeyNumber(label, lead.range_of(known), note, verdict)
