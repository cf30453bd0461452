"""What stands below the answer: what contacts cost, what was typed in, and what was missed."""

from __future__ import annotations

import math
from collections.abc import Sequence

from simcompare.compare.comparison import FAIL, PASS, Score
from simcompare.engine.engines import VARIANT
from simcompare.model.settings import SHOWN_LEVELS, TUNED
from simcompare.model.trajectory import AT
from simcompare.model.tuning import TuningRow
from simcompare.reports.render import numbers
from simcompare.reports.run import listing, runs
from simcompare.reports.run.lead import Lead, first_events, groups_of, lead_of
from simcompare.reports.run.level_phrases import how, merged
from simcompare.reports.run.not_run import not_run
from simcompare.results.records.run import SourceRecord
from simcompare.results.run import Run
from simcompare.running.jobs import OK

#: contacts whose depths differ by less than this factor are told as one
_ALIKE_DEPTHS = 2.0
#: a depth below this part of the body's size is called small
_SHALLOW = 0.01


def remarks(run: Run) -> list[str]:
    """Sentences, as far as there is something to say."""
    judged = [mode for mode in runs.modes(run) if mode not in SHOWN_LEVELS]
    found = [*_means(run, judged), *_typed_in(run), _contacts(run)]
    found += merged((how(run, mode), _missed(run, mode)) for mode in judged)
    found += [*_variants(run), *_not_run(run)]
    if run.record.interrupted:
        found.append("The run was interrupted before it was complete.")
    return [sentence for sentence in found if sentence]


def _means(run: Run, judged: Sequence[str]) -> list[str]:
    """What the scatter is, and what the first event gives where the value is a mean of several."""
    lead, repeats = lead_of(run), run.record.repeats
    if lead is None:
        return []
    found = []
    dither = run.record.dither
    if repeats > 1 and dither:
        found.append(f"± is the standard deviation over {repeats} repeats. {dither.reason}")
    if lead.of_events and not runs.steps(run):
        found += merged((how(run, mode), _first(run, lead, mode)) for mode in judged)
    return found


def _first(run: Run, lead: Lead, mode: str) -> str:
    rows = first_events(run, lead, mode)
    every = runs.ran(run, mode)
    said = [
        f"{lead.told(group.rows)} in {listing.engines(group.names, every)}"
        for group in groups_of(lead, rows)
    ]
    return f"the first {lead.words} alone is {', '.join(said)}" if said else ""


def _variants(run: Run) -> list[str]:
    """What each variant is, as its source notes it."""
    found: dict[str, str] = {}
    for source in run.record.sources:
        name = source.name.partition(AT)[0]
        mark = f"variant {name.partition(VARIANT)[2]}: "
        for note in source.notes:
            if VARIANT in name and note.startswith(mark):
                # behind it stands where that is documented
                found[name] = note.removeprefix(mark).rpartition(" [")[0]
    return [f"{name}: {text}." for name, text in found.items()]


def typed(source: SourceRecord, record: TuningRow, digits: int = 6) -> str:
    """The numbers of a tuning under the names of the engine's own parameters."""
    names = {
        row.set_value: row.engine_parameter
        for row in source.audit
        if row.quantity.endswith("restitution")
    }
    return ", ".join(
        f"{names[value]} = {numbers.plain(value, digits)}"
        if value in names
        else numbers.plain(value, digits)
        for value in record.numbers
    )


#: how all of so many tolerances are called
_ALL = {1: "the one tolerance is", 2: "both tolerances are"}


def _tuned(run: Run) -> list[tuple[SourceRecord, TuningRow]]:
    """Sources of the level tuned, each with the first record of its tuning."""
    sources = [source for source in run.record.sources if source.contact == TUNED]
    return [(source, source.tuning[0]) for source in sources if source.tuning]


def _contacts(run: Run) -> str:
    """How deep the first contact sinks and how long it lasts, engines alike together."""
    known = [
        (at.penetration_m, at.contact_s, source.name, record.size_m)
        for source, record in _tuned(run)
        for at in record.at[:1]
        if math.isfinite(at.penetration_m) and math.isfinite(at.contact_s)
    ]
    if not known:
        return ""
    head = "In the drops that were tuned, the first contact sinks up to"
    if runs.steps(run):
        return f"{head}, and lasts: {'; '.join(_over_steps(known))}."
    groups: list[list[tuple[float, float, str, float]]] = []
    for one in sorted(known, key=lambda row: -row[0]):
        first = groups[-1][0] if groups else None
        if first and (first[0] <= _ALIKE_DEPTHS * one[0] or first[0] <= _SHALLOW * first[3]):
            groups[-1].append(one)
        else:
            groups.append([one])
    order = runs.names(run)
    said = [_contact(sorted(group, key=lambda row: order.index(row[2]))) for group in groups]
    return f"{head} {'; '.join(said)}."


def _over_steps(known: Sequence[tuple[float, float, str, float]]) -> list[str]:
    """Depths and times of each engine, in the order of the steps."""
    by_engine: dict[str, list[tuple[float, float]]] = {}
    for depth, lasts, name, _ in known:
        by_engine.setdefault(name.partition(AT)[0], []).append((1e3 * depth, 1e3 * lasts))
    found = []
    for engine, rows in by_engine.items():
        depths, times = (
            [numbers.plain(v, 2) for v in column] for column in zip(*rows, strict=True)
        )
        found.append(f"{', '.join(depths)} mm, and {', '.join(times)} ms in {engine}")
    return found


def _contact(group: Sequence[tuple[float, float, str, float]]) -> str:
    depth, size = max(row[0] for row in group), group[0][3]
    lasts = _span([1e3 * row[1] for row in group], "ms")
    names = listing.joined([row[2] for row in group])
    if depth <= _SHALLOW * size:
        most = numbers.plain(1e3 * _SHALLOW * size, 2)
        return f"{most} mm and lasts {lasts} in {names}"
    return f"{_span([1e3 * row[0] for row in group], 'mm')} and lasts {lasts} in {names}"


def _span(values: Sequence[float], unit: str, digits: int = 2) -> str:
    low, high = (numbers.plain(value, digits) for value in (min(values), max(values)))
    after = f" {unit}" if unit else ""
    return f"{low}{after}" if low == high else f"{low} to {high}{after}"


def _typed_in(run: Run) -> list[str]:
    """Which numbers stand for each restitution, engine by engine."""
    sources = [source for source in run.record.sources if source.contact == TUNED]
    sources.sort(key=lambda source: float(source.engine_step_s or 0.0))
    rows = [(source, record) for source in sources for record in source.tuning]
    return [
        _typed_for(run, restitution, [row for row in rows if row[1].restitution == restitution])
        for restitution in dict.fromkeys(record.restitution for _, record in rows)
    ]


def _typed_for(run: Run, restitution: float, rows: Sequence[tuple[SourceRecord, TuningRow]]) -> str:
    by_engine: dict[str, list[str]] = {}
    for source, record in rows:  # at several steps, one after the other
        engine = source.name.partition(AT)[0]
        by_engine.setdefault(engine, []).append(_short(source, record))
    said = [f"{', '.join(numbers)} in {engine}" for engine, numbers in by_engine.items()]
    goal = f" for a restitution of {numbers.plain(restitution)}"
    steps = [
        step.at.removeprefix(AT)
        for step in sorted(runs.steps(run), key=lambda step: step.engine_step_s)
    ]
    at = f" at {listing.joined(steps)}" if steps else ""
    return f"Typed in{goal}{at}: {('; ' if steps else ', ').join(said)}."


def _short(source: SourceRecord, record: TuningRow) -> str:
    """A coefficient alone; the numbers of a parameter with several under its name."""
    values = [numbers.plain(value) for value in record.numbers]
    if len(values) == 1:
        return numbers.plain(record.numbers[0], 4)
    whole = typed(source, record).partition("[")[0]
    return f"{whole} = ({', '.join(values)})" if "=" not in whole else typed(source, record, 4)


def _missed(run: Run, mode: str) -> str:
    """Which tolerances are missed at a level, and by which engines."""
    every, judged = runs.ran(run, mode), runs.judged(run)
    if not every or not judged:
        return ""
    lacking = {name: lost for name in every if (lost := _unmeasured(run, name, mode))}
    whole = [name for name in every if name not in lacking]
    by_names: dict[tuple[str, ...], list[str]] = {}
    for measure in judged:
        names = tuple(name for name in every if _failed(run, name, mode, measure))
        if names:
            by_names.setdefault(names, []).append(runs.measure_words(measure))
    said = [
        f"{listing.joined(measures)} by {listing.engines(names, every)}"
        for names, measures in sorted(by_names.items(), key=lambda item: -len(item[0]))
    ]
    if said:
        said = [f"missed: {'; '.join(said)}{_worst(run, mode)}"]
    elif whole:
        what = _ALL.get(len(judged), f"all {len(judged)} tolerances are")
        said = [f"{what} met in {listing.engines(whole, every)}"]
    said += [_met(run, name, mode, lost) for name, lost in lacking.items()]
    return "; ".join(said)


def _failed(run: Run, name: str, mode: str, measure: str) -> bool:
    score = runs.score_of(run, name, mode, measure)
    return score is not None and score.verdict == FAIL


def _unmeasured(run: Run, name: str, mode: str) -> list[Score | None]:
    """What has a tolerance and was neither met nor missed: there is nothing to judge."""
    scores = [runs.score_of(run, name, mode, measure) for measure in runs.judged(run)]
    return [one for one in scores if one is None or one.verdict not in (PASS, FAIL)]


def _met(run: Run, name: str, mode: str, lost: Sequence[Score | None]) -> str:
    """How many tolerances a source met where not all could be judged, and why not."""
    met, _ = runs.passed(run, name, mode)
    were = "was" if len(lost) == 1 else "were"
    reasons = "; ".join(dict.fromkeys(one.lacking for one in lost if one and one.lacking))
    why = f" ({reasons})" if reasons else ""
    of = len(runs.judged(run))
    return f"in {name} {met} of {of} tolerances are met, {len(lost)} {were} not measured{why}"


def _worst(run: Run, mode: str) -> str:
    """The value that is farthest from the truth, in tolerances."""
    found = [
        runs.score_of(run, name, mode, m) for m in runs.judged(run) for name in runs.names(run)
    ]
    shares = [
        (share, score)
        for score in found
        if score is not None and (share := runs.share_of_tolerance(run, score)) is not None
    ]
    if not shares:
        return ""
    share, score = max(shares, key=lambda pair: pair[0])
    off = abs((score.value or 0.0) - (score.truth or 0.0))
    if share <= 1:  # what was missed could not be measured
        return ""
    far = numbers.with_u(off, score.scatter, score.unit, score.truth, 2)
    return (
        f"; farthest is {score.source}, {runs.measure_words(score.measure)} off by {far},"
        f" {numbers.plain(share, 2)} times the tolerance"
    )


def _not_run(run: Run) -> list[str]:
    """Engines that did not run at any level, and those that ran at some, by what became of them."""
    heads: dict[str, dict[str, list[str]]] = {}
    for name in dict.fromkeys(row.name for row in not_run(run)):
        own = [source for source in run.record.sources if source.name == name]
        bad = [source for source in own if source.status != OK]
        levels = listing.joined([runs.mode_words(source.contact) for source in bad])
        head = "Did not run" if len(bad) == len(own) else f"Not run {levels}"
        for status in dict.fromkeys(source.status for source in bad):
            heads.setdefault(head, {}).setdefault(status, []).append(name)
    found = []
    for head, by_status in heads.items():
        said = [f"{listing.joined(sorted(n))} ({status})" for status, n in by_status.items()]
        found.append(f"{head}: {'; '.join(said)}.")
    if found:
        found[-1] += " The reasons are below."
    return found
