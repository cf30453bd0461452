"""The answer of a validation in at most 40 words, and the few numbers that it begins with."""

from __future__ import annotations

from simcompare.reports.render.parts import KeyNumber
from simcompare.reports.validation import answer_gap, answer_values, beginnings, phrases
from simcompare.results.records.validation import SAME, Validation


def short(validation: Validation) -> tuple[str, ...]:
    """How far simulation and recording are apart, and whether that was to be expected."""
    if not validation.waveforms and not validation.timings:
        return ("No engine ran.",)
    if validation.apart:
        return (*beginnings.sentences(validation), *_gap(validation))
    return (*_unsure(validation), *_gap(validation), *_values(validation), _basis(validation))


def key_numbers(validation: Validation) -> tuple[KeyNumber, ...]:
    """Three or four numbers."""
    return (*_gap_numbers(validation), *_event_numbers(validation), *_value_numbers(validation))


def _probe(validation: Validation) -> str | None:
    """The leading quantity that is judged."""
    return next((row.probe for row in validation.waveforms if row.judged), None)


def _unsure(validation: Validation) -> list[str]:
    if any(one is not None and one.ambiguous for one in validation.alignments):
        return ["The clocks are not aligned with certainty."]
    return []


def _gap(validation: Validation) -> list[str]:
    probe = _probe(validation)
    if probe is None:
        return []
    rows = answer_gap.judged_rows(validation, probe)
    size = phrases.size_span([row.rmse for row in rows], rows[0].unit)
    label = phrases.label(validation, probe)
    return [f"The simulated {label} is off by {size} (RMS)."]


def _values(validation: Validation) -> list[str]:
    scores = answer_values.scores(validation)
    return [f"{answer_values.agreeing(scores, 'value')}."] if scores else []


def _basis(validation: Validation) -> str:
    if validation.fit is None:
        return "Nothing was fitted."
    if validation.basis == SAME:
        return "The same data were fitted: this is no validation."
    return "The parameters were fitted to other data."


def _gap_numbers(validation: Validation) -> list[KeyNumber]:
    probe = _probe(validation)
    if probe is None:
        return []
    rows = answer_gap.judged_rows(validation, probe)
    engines = phrases.counted(len(phrases.engines_of(rows)), "engine")
    size = phrases.size_span([row.rmse for row in rows], rows[0].unit)
    label = phrases.first_up(phrases.label(validation, probe))
    found = [KeyNumber(f"{label}: off by", size, f"RMS, {engines}")]
    before = answer_gap.before_the_fit(validation, rows)
    if before:
        size = phrases.size_span([row.rmse for row in before], rows[0].unit)
        found.append(KeyNumber("before the fit", size, "RMS"))
    return found


def _event_numbers(validation: Validation) -> list[KeyNumber]:
    rows = validation.timings
    if not rows or validation.waveforms:
        return []
    worst = min(rows, key=lambda row: row.matched)
    count = f"{worst.matched} of {worst.matched + worst.missed}"
    apart = [row.rmse_s for row in rows if row.rmse_s is not None]
    found = [KeyNumber("events with a partner", count, f"in {worst.source}")]
    if apart:
        found.append(KeyNumber("apart", phrases.size_span(apart, "s"), "RMS"))
    return found


def _value_numbers(validation: Validation) -> list[KeyNumber]:
    scores = answer_values.scores(validation)
    if not scores:
        return []
    good, count = answer_values.within(scores)
    worst = max(scores, key=lambda row: abs(row.e_n))
    where = f"{phrases.spaced(worst.measure)}, {worst.source}{phrases.where(validation, worst)}"
    return [
        KeyNumber("values that agree", f"{good} of {count}", "|E_n| ≤ 1"),
        KeyNumber("largest E_n", answer_values.e_n_words(worst.e_n), where),
    ]
