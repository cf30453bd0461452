"""The answer of a run in at most 40 words: one short sentence for each contact level."""

from __future__ import annotations

from simcompare.reports.run.key_numbers import key_numbers
from simcompare.reports.run.lead import lead_of
from simcompare.results.run import Run

#: so many words are read before the first figure
MAX_WORDS = 40


def short(run: Run) -> tuple[str, ...]:
    """What the run answers, level by level."""
    lead = lead_of(run)
    if lead is None:
        return ("Nothing was measured.",)
    sentences = [
        f"{number.label.capitalize()}: {lead.words} {number.value}"
        + (f" ({number.note})." if number.note else ".")
        for number in key_numbers(run)
    ]
    while len(" ".join(sentences).split()) > MAX_WORDS and len(sentences) > 1:
        sentences.pop(0)
    return tuple(sentences)
