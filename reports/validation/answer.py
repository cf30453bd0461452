"""What a validation found, in plain words: how large the gap is, how sure, what it is made of."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from simcompare.reports.validation import answer_basis, answer_gap, answer_values, phrases
from simcompare.reports.validation.phrases import HELD_OUT, KNOWN, SAME

__all__ = ["HELD_OUT", "KNOWN", "SAME", "sentences", "verdict", "with_words"]

Record = Mapping[str, Any]


def with_words(found: Record) -> dict[str, Any]:
    """The record with a verdict on every value and the answer in sentences.

    Args:
        found: the record of the validation.
    """
    values = [{**row, "words": verdict(row, found["basis"])} for row in found["values"]]
    return {**found, "values": values, "sentences": sentences(found)}


def verdict(row: Record, basis: str) -> str:
    """One value in words; "within the noise level" is not "validated"."""
    if row["e_n"] is None:
        return "not judged: u unknown"
    if not row["within_noise"]:
        return "beyond the uncertainties"
    if basis == SAME:
        return "within the noise level (same data)"
    return "within the noise level"


def sentences(found: Record) -> list[str]:
    """The answer of a validation.

    Args:
        found: the record of the validation.
    """
    if not found["waveforms"] and not found.get("timings"):
        return ["No engine ran, so nothing can be said."]
    return [
        *_clocks(found),
        *_cut(found),
        *answer_gap.sentences(found),
        *answer_values.sentences(found),
        *answer_basis.sentences(found),
        *_log(found),
        *answer_basis.advice(found),
    ]


def _clocks(found: Record) -> Iterator[str]:
    """Whether the clocks could be aligned in more than one way."""
    alignments = found.get("alignments") or []
    streams = [
        case["stream"]
        for case, one in zip(found["cases"], alignments, strict=False)
        if one and one.get("ambiguous")
    ]
    if streams:
        on = f" ({', '.join(streams)})" if len(found["cases"]) > 1 else ""
        yield (
            f"The clocks are not aligned with certainty{on}: another offset fits about as well, so"
            " everything that compares times may be wrong."
        )


def _cut(found: Record) -> Iterator[str]:
    """Windows that are shorter than was asked for."""
    cut = [case for case in found["cases"] if case.get("short")]
    if not cut:
        return
    lengths = phrases.size_span([case["duration_s"] for case in cut], "s")
    if len(found["cases"]) > 1:
        lengths += f" of {', '.join(case['stream'] for case in cut)}"
    yield f"The log ends before the window that was asked for: only {lengths} are judged."


def _log(found: Record) -> Iterator[str]:
    """Defects of the log that a reader of the answer must know of."""
    repairs = found["provenance"]["repairs"]
    told = []
    for severity, words in (("repair", "repaired"), ("warning", "left and marked")):
        rules = dict.fromkeys(
            phrases.spaced(r["rule"]) for r in repairs if r["severity"] == severity
        )
        if rules:
            told.append(f"{words}: {', '.join(rules)}")
    if told:
        yield f"The log had defects ({'; '.join(told)}); the section on the recording has the rows."
