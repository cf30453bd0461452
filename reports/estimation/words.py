"""What an estimation says, in sentences: how far off, whether the filter knows it, what to change.

A filter that is not consistent is told with the test that shows it.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence

from simcompare import units
from simcompare.estimation.consistency import Verdict
from simcompare.notation import capital
from simcompare.reports.characterization.words import percent, rounded
from simcompare.reports.estimation import chips, drift, units_of
from simcompare.reports.run.listing import joined
from simcompare.results.records.estimation import Estimation, Reading, SourceEstimate

#: correlation of neighbouring innovations that is worth a sentence
_CLEAR = 0.2
#: outcomes of a filter that errs more than it says
_MORE = ("too sure", "diverged")
#: part of readings beyond which it is not the readings that are wrong
_MANY = 0.2


def sentences(result: Estimation) -> Iterator[str]:
    """The answer, the verdict, its cause, and what to change."""
    if not result.done:
        yield from (f"{one.source}: {one.reason}" for one in result.sources if one.reason)
        return
    answer = [*chips.sentences(result), *drift.sentences(result)]
    yield from answer or _errors(result, lead_state(result))
    yield from _verdicts(result)
    yield from _diameter(result)
    for one in result.done:
        for row in one.readings:
            if row.refused >= 1:
                part = f"{row.refused:.0f} of {row.count:.0f} readings of {row.name}"
                yield f"{one.source}: {part} could not be, and were refused."


def lead_state(result: Estimation) -> str:
    """The state that leads: the first of which the truth is known, else the first."""
    known = [
        one.state for source in result.done for one in source.errors if one.rms_error is not None
    ]
    ranked = [state for state in result.labels if state in known]
    return (ranked or list(result.labels))[0]


def ways_of(result: Estimation, state: str) -> list[str]:
    """Ways that tell a state: what sensors say alone, then the filter and the smoother."""
    told = [one.way for source in result.done for one in source.errors if one.state == state]
    mended = [way for way in (*result.done[0].ways[:1], "smoothed") if way in told]
    return [*(way for way in dict.fromkeys(told) if way not in mended), *mended]


def _errors(result: Estimation, state: str) -> Iterator[str]:
    """How far each way is off over all sources, the estimator's own answer first."""
    ways = {way: _rms(result, way, state) for way in ways_of(result, state)}
    ways = {way: ways[way] for way in dict.fromkeys([*result.done[0].ways, *ways]) if ways.get(way)}
    label = result.labels[state].lower()
    if not ways:
        yield f"Nobody knows the true {label}, so no error is told."
        return
    factor, unit = units_of.scale(state, [one for row in ways.values() for one in row])
    (first, own), *rest = [(way, f"{_span(row, factor)} {unit}") for way, row in ways.items()]
    others = joined([f"{way} by {size}" for way, size in rest])
    whose = joined([one.source for one in result.done])
    often = f"; {result.draws} draws of the sensors" if result.draws > 1 else ""
    yield (
        f"{capital(first)}, the {label} is off by {own}{f'; {others}' if others else ''}"
        f" (rms; {whose}{often})."
    )


def _rms(result: Estimation, way: str, state: str) -> list[float]:
    found = [one.error_of(way, state) for one in result.done]
    return [one.rms_error for one in found if one is not None and one.rms_error is not None]


def _span(values: Sequence[float], factor: float) -> str:
    low, high = (units_of.text(one, factor) for one in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def _verdicts(result: Estimation) -> Iterator[str]:
    """What NEES, or NIS where nobody knows the truth, say; sources that say the same together."""
    groups: dict[str, list[SourceEstimate]] = {}
    for one in result.done:
        verdict = leading(one)
        if verdict is not None:
            groups.setdefault(verdict.outcome, []).append(one)
    for outcome, sources in groups.items():
        verdicts = [found for one in sources if (found := leading(one)) is not None]
        whose = "" if len(groups) == 1 else f"{joined([one.source for one in sources])}: "
        yield whose + _said(outcome, verdicts)
        yield from _of_one_run(verdicts)
        yield from _causes(result, outcome, sources)
    yield from _surprised(result)


def _surprised(result: Estimation) -> Iterator[str]:
    """Innovations that are larger than the filter expects, where its errors do not show it."""
    found = [
        one.nis
        for one in result.done
        if one.nis and one.nis.outcome in _MORE and (one.nees and one.nees.outcome not in _MORE)
    ]
    if found:
        most = max(found, key=lambda one: one.value)
        limits = f"{rounded(most.low, 3)} … {rounded(most.high, 3)}"
        yield f"But readings surprise it: NIS {rounded(most.value, 3)}, above {limits}."
        yield from _cures(result)


def leading(source: SourceEstimate) -> Verdict | None:
    """The test that judges a source: NEES where the truth is known, else NIS."""
    return source.nees or source.nis


def _said(outcome: str, verdicts: Sequence[Verdict]) -> str:
    first = verdicts[0]
    values = [one.value for one in verdicts]
    low, high = rounded(min(values), 3), rounded(max(values), 3)
    value = low if low == high else f"{low} to {high}"
    band = f"{rounded(first.low, 3)} … {rounded(first.high, 3)}"
    match outcome:
        case "consistent":
            return f"The filter errs as much as it says: {first.name} {value}, within {band}."
        case "too careful":
            return f"The filter errs less than it says: {first.name} {value}, below {band}."
        case "too sure":
            return f"The filter errs more than it says: {first.name} {value}, above {band}."
    return (
        f"The filter has diverged: its errors are far larger than it says, {first.name} {value}"
        f" where {band} is expected."
    )


def _of_one_run(verdicts: Sequence[Verdict]) -> Iterator[str]:
    """How often one run alone was as near to the truth as was said: its band is wide."""
    for one in verdicts:
        if one.runs == 1 and one.name == "NEES" and one.inside is not None:
            yield (
                f"One run says little, as its band is wide. NEES is within it at"
                f" {percent(one.inside)} of the instants, where about 95 % are expected."
            )


def _causes(result: Estimation, outcome: str, sources: Sequence[SourceEstimate]) -> Iterator[str]:
    """What the innovations say of it, and the command that changes it."""
    coloured = [
        one for one in sources[0].readings if one.whiteness and one.whiteness.outcome == "not white"
    ]
    against = [one for one in coloured if _lag(one) < -_CLEAR]
    yield from _cancelling(result, [one for one in against if one.counted])
    fast = [one for one in against if not one.counted]
    if fast:
        yield (
            f"Neighbouring innovations of {_named(fast)} cancel (correlation"
            f" {rounded(min(map(_lag, fast)))}): the model lets the motion change faster than it"
            f" does. {_scaled(result, 0.1, 'Let it differ less')}"
        )
    along = [one for one in coloured if _lag(one) > _CLEAR]
    if along:
        yield (
            f"Neighbouring innovations of {_named(along)} agree (correlation"
            f" {rounded(max(map(_lag, along)))}): something that lasts is not in the model."
        )
    if outcome in _MORE:
        yield from _cures(result)


def _cancelling(result: Estimation, counted: Sequence[Reading]) -> Iterator[str]:
    """Why the errors of counts cancel, and how they are read better."""
    if not counted:
        return
    yield (
        f"Neighbouring innovations of {_named(counted)} cancel (correlation"
        f" {rounded(min(map(_lag, counted)))}): what one count has too much, the next has too"
        " little. So errors add up to less than those of white noise would."
    )
    sums = {name: 1.0 for name in result.sums if not result.options[name]}
    if sums:
        yield f"Read the counts as a sum, a state more: {with_options(result.command, sums)}"


def _lag(reading: Reading) -> float:
    """Correlation of neighbouring innovations."""
    return (reading.whiteness.lag_1 or 0.0) if reading.whiteness else 0.0


def _named(readings: Sequence[Reading]) -> str:
    return joined([one.name for one in readings])


def _scaled(result: Estimation, factor: float, what: str) -> str:
    """The command with other noise of the motion; empty where the estimator has none."""
    if not result.loosen:
        return ""
    changed = {name: factor * result.options[name] for name in result.loosen}
    return f"{what}: {with_options(result.command, changed)}"


def _cures(result: Estimation) -> Iterator[str]:
    biases = {name: 1.0 for name in result.biases if not result.options[name]}
    if biases:
        command = with_options(result.command, biases)
        yield f"A constant error of a sensor is no noise; make it a state: {command}"
        return
    refused = [r.name for one in result.done for r in one.readings if r.refused > _MANY * r.count]
    if refused:
        yield (
            f"Many readings of {joined(list(dict.fromkeys(refused)))} do not fit the motion: a"
            " number of the model, or what a channel means, may be wrong."
        )
        return
    looser = _scaled(result, 10, "Let the motion differ more from the model")
    if looser:
        yield looser


def with_options(command: Sequence[str], options: Mapping[str, float]) -> str:
    """The same command with other options."""
    kept: list[str] = []
    words = iter(command)
    for word in words:
        value = next(words, "") if word == "--option" else ""
        if word != "--option":
            kept.append(word)
        elif units.find_name(value.partition("=")[0], options) is None:
            kept += [word, value]
    assigned = [f"{name}={value:g}" for name, value in options.items()]
    changed = [word for one in assigned for word in ("--option", one)]
    return shlex.join([*kept, *changed])


def _diameter(result: Estimation) -> Iterator[str]:
    """What is systematic, and in no filter."""
    found = [one.numbers.get("speed_open_by_diameter") for one in result.done]
    values = [one.value for one in found if one is not None]
    if values:
        size = units_of.text(max(values), 1e3)
        yield (
            f"The wheel's diameter adds u = {size} mm/s: it is the same in every"
            " reading, so no filter averages it out."
        )
