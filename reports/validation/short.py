"""The answer of a validation in at most 40 words, and the few numbers that it begins with."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.reports.render.parts import KeyNumber
from simcompare.reports.validation import answer_gap, answer_values, beginnings, phrases
from simcompare.results.records.validation import SAME, Validation, WaveformRecord

MAX_WORDS = 40
#: engines are alike where the least is more than this part of the greatest
_ALIKE = 0.95
#: more streams, or values, than these are not named one by one
_TWO = 2


def short(validation: Validation) -> tuple[str, ...]:
    """How far simulation and recording are apart, and whether that was to be expected."""
    if not validation.waveforms and not validation.timings:
        return ("No engine ran.",)
    if validation.apart:
        return (*beginnings.sentences(validation), *_gap(validation))
    said = [*_unsure(validation), *_gap(validation), *_worse(validation), *_values(validation),
            _basis(validation)]  # fmt: skip
    while sum(len(sentence.split()) for sentence in said) > MAX_WORDS:
        said.pop()  # the last is the least important
    return tuple(said)


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
    label = phrases.label(validation, probe)
    return [f"The simulated {label} is off by {_off(validation, probe)}."]


def _off(validation: Validation, probe: str) -> str:
    """How far, for each of two streams; of more, the least and the greatest."""
    rows = answer_gap.judged_rows(validation, probe)
    streams = list(dict.fromkeys(row.stream for row in rows))
    if len(streams) == _TWO:
        own = [[row for row in rows if row.stream == stream] for stream in streams]
        return " and ".join(f"{_near(part)} ({part[0].stream})" for part in own)
    size = phrases.size_span([row.rmse for row in rows], rows[0].unit)
    return f"{size} (RMS)" + (f" in {len(streams)} recordings" if len(streams) > _TWO else "")


def _near(rows: Sequence[WaveformRecord]) -> str:
    """One size for engines that hardly differ, else the least and the greatest."""
    sizes = [row.rmse for row in rows]
    if min(sizes) < _ALIKE * max(sizes):
        return phrases.size_span(sizes, rows[0].unit)
    factor, symbol = phrases.people_unit(rows[0].unit, sizes)
    return phrases.sized(float(f"{factor * max(sizes):.2g}"), symbol).replace(" °", "°")


def _worse(validation: Validation) -> list[str]:
    worse = answer_gap.worse(validation, validation.gaps)
    if not worse:
        return []
    return [f"The fit does not carry over: the gap grew by up to {phrases.percent(worse)}."]


def _values(validation: Validation) -> list[str]:
    """How many values agree, and which they are."""
    scores = answer_values.scores(validation)
    good, count = answer_values.within(scores)
    if count < _TWO:
        return [f"{answer_values.agreeing(scores, 'value')}."] if scores else []
    names = list(dict.fromkeys(phrases.spaced(score.measure) for score in scores))
    listed = ", ".join(names[:_TWO]) + (" …" if len(names) > _TWO else "")
    streams = len({score.stream for score in scores})
    each = " of both" if streams == _TWO else " of each recording" if streams > _TWO else ""
    agree = "agrees" if good == 1 else "agree"
    return [f"{good} of {count} values ({listed}{each}) {agree}."]


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
