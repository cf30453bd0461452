"""What a validation found, in plain words: how large the gap is, how sure, what it is made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from simcompare.model.recording import REPAIR, WARNING, Provenance
from simcompare.reports import suspicions
from simcompare.reports.validation import (
    answer_basis,
    answer_gap,
    answer_values,
    beginnings,
    phrases,
)
from simcompare.results.records.validation import SAME, Validation, ValueRecord

#: rules by which what is said of a log contradicts it: the reader has to decide
CONTRADICTIONS = ("drive",)


def with_words(validation: Validation) -> Validation:
    """The record with a verdict on every value and the answer in sentences.

    Args:
        validation: the record of the validation.
    """
    values = tuple(replace(row, words=verdict(row, validation.basis)) for row in validation.values)
    return replace(validation, values=values, sentences=tuple(sentences(validation)))


def verdict(row: ValueRecord, basis: str) -> str:
    """One value in words; "within the uncertainty" is not "validated"."""
    if row.e_n is None:
        return "not judged: u unknown"
    if not row.within_noise:
        return "beyond the uncertainty"
    if basis == SAME:
        return "within the uncertainty (same data)"
    return "within the uncertainty"


def sentences(validation: Validation) -> list[str]:
    """The answer of a validation.

    Args:
        validation: the record of the validation.
    """
    if not validation.waveforms and not validation.timings:
        return ["No engine ran, so nothing can be said."]
    return [
        *beginnings.sentences(validation),
        *_clocks(validation),
        *_cut(validation),
        *answer_gap.sentences(validation),
        *answer_values.sentences(validation),
        *answer_basis.sentences(validation),
        *_log(validation),
        *answer_basis.advice(validation),
    ]


def remarks(validation: Validation) -> list[str]:
    """What must be known besides of the recording, and what to do next.

    Args:
        validation: the record of the validation.
    """
    return [*_clocks(validation), *_cut(validation), *_log(validation),
            *answer_basis.advice(validation)]  # fmt: skip


def _clocks(validation: Validation) -> Iterator[str]:
    """Whether the clocks could be aligned in more than one way."""
    pairs = zip(validation.cases, validation.alignments, strict=False)
    streams = [case.stream for case, one in pairs if one is not None and one.ambiguous]
    if streams:
        on = f" ({', '.join(streams)})" if len(validation.cases) > 1 else ""
        yield (f"The clocks are not aligned with certainty{on}: another offset fits about as well.")


def _cut(validation: Validation) -> Iterator[str]:
    """Windows that are shorter than was asked for."""
    cut = [case for case in validation.cases if case.short]
    if not cut:
        return
    lengths = phrases.size_span([case.duration_s for case in cut], "s")
    if len(validation.cases) > 1:
        lengths += f" of {', '.join(case.stream for case in cut)}"
    yield f"The log ends early: only {lengths} are judged."


def contradictions(provenance: Provenance) -> Iterator[str]:
    """Where what is said of a log contradicts it, so that its reader has to decide."""
    for one in provenance.repairs:
        if one.rule in CONTRADICTIONS:
            yield f"What is said of the log contradicts it: {one.text}."


def _log(validation: Validation) -> Iterator[str]:
    """Defects of the log that a reader of the answer must know of."""
    told = [*contradictions(validation.provenance)]
    if validation.suspected is not None and not told:
        told = [suspicions.of_range(validation.suspected)]
    yield from told
    defects = []
    for severity, words in ((REPAIR, "repaired"), (WARNING, "left and marked")):
        rules = dict.fromkeys(
            phrases.spaced(one.rule)
            for one in validation.provenance.repairs
            if one.severity == severity and one.rule not in CONTRADICTIONS
        )
        if rules:
            defects.append(f"{words}: {', '.join(rules)}")
    if defects:
        listed = "; ".join(defects)
        yield f"The log had defects ({listed}); see the section on the recording."
