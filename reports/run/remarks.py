"""What stands below the answer: what contacts cost, what was typed in, and what was missed."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.comparison.comparison import FAIL, PASS, Score
from simcompare.engine.engines import VARIANT
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import AT
from simcompare.reports.render import numbers
from simcompare.reports.run import runs
from simcompare.reports.run.lead import Lead, lead_of
from simcompare.reports.run.lead_rows import first_events, groups_of
from simcompare.reports.run.level_phrases import merged
from simcompare.reports.run.listing import engines, grouped, joined
from simcompare.reports.run.tuning_phrases import contacts, typed_in
from simcompare.results.records.run import RunRecord, SourceRecord
from simcompare.results.run import Run

#: how all of so many judged values are called
_ALL = {1: "the one judged value is", 2: "both judged values are"}


def remarks(run: Run) -> list[str]:
    """Sentences, as far as there is something to say."""
    judged = [mode for mode in runs.modes(run) if mode not in SHOWN_LEVELS]
    sentences = [*_means(run, judged), *typed_in(run), contacts(run)]
    sentences += merged(run, ((mode, _missed(run, mode)) for mode in judged))
    sentences += [*_variants(run), *_not_run(run)]
    if isinstance(run.record, RunRecord):
        sentences += [f"Caution: {caution}." for caution in run.record.cautions]
    if run.record.interrupted:
        sentences.append("The run was interrupted before it was complete.")
    return list(filter(None, sentences))


def failures(run: Run) -> list[str]:
    """What makes a run fail, a sentence for each level at which it does."""
    failed = [mode for mode in runs.modes(run) if mode in run.failed_levels]
    return merged(run, ((mode, _missed(run, mode)) for mode in failed))


def _means(run: Run, judged: Sequence[str]) -> list[str]:
    """What the scatter is, and what the first event gives where the value is a mean of several."""
    lead, repeats = lead_of(run), run.record.repeats
    if lead is None:
        return []
    sentences = []
    dither = run.record.dither
    if repeats > 1 and dither:
        sentences.append(f"± is the standard deviation over {repeats} repeats. {dither.reason}")
    if lead.of_events and not runs.steps(run):
        sentences += merged(run, ((mode, _first(run, lead, mode)) for mode in judged))
    return sentences


def _first(run: Run, lead: Lead, mode: str) -> str:
    rows = first_events(run, lead, mode)
    every = runs.ran(run, mode)
    phrases = [
        f"{lead.range_of(group.rows)} in {engines(group.names, every)}"
        for group in groups_of(lead, rows)
    ]
    return f"the first {lead.words} alone is {', '.join(phrases)}" if phrases else ""


def _variants(run: Run) -> list[str]:
    """What each variant is, as its source notes it."""
    texts: dict[str, str] = {}
    for source in run.record.sources:
        name = source.name.partition(AT)[0]
        mark = f"variant {name.partition(VARIANT)[2]}: "
        for note in source.notes:
            if VARIANT in name and note.startswith(mark):
                # behind it stands where that is documented
                texts[name] = note.removeprefix(mark).rpartition(" [")[0]
    return [f"{name}: {text}." for name, text in texts.items()]


def _missed(run: Run, mode: str) -> str:
    """Which tolerances are missed at a level, and by which engines."""
    every, judged = runs.ran(run, mode), runs.judged(run)
    if not every or not judged:
        return ""
    unmeasured = {name: left for name in every if (left := _unmeasured(run, name, mode))}
    off, lost = (
        _by_names(run, mode, every, known=True), _by_names(run, mode, every, known=False)
    )  # fmt: skip
    without = {*unmeasured, *(name for names in lost for name in names)}
    complete = [name for name in every if name not in without]
    far = _farthest(run, mode)
    phrases = [_off(run, measures, names, every, far) for names, measures in off.items()]
    if phrases:
        phrases = [f"too far off: {'; '.join(phrases)}"]
    elif complete:
        all_are = _ALL.get(len(judged), f"all {len(judged)} judged values are")
        phrases = [f"{all_are} right in {engines(complete, every)}"]
    phrases += [
        f"{_words(measures)} could not be measured in {engines(names, every)}"
        for names, measures in lost.items()
    ]
    phrases += [_met(run, name, mode, left) for name, left in unmeasured.items()]
    return "; ".join(phrases)


def _by_names(
    run: Run, mode: str, every: Sequence[str], *, known: bool
) -> dict[tuple[str, ...], list[str]]:
    """Measures by the engines that miss them, most engines first: off, or without a value."""
    missed = {
        m: tuple(n for n in every if _failed(run, n, mode, m, known=known))
        for m in runs.judged(run)
    }
    by_names = grouped((names, measure) for measure, names in missed.items() if names)
    return dict(sorted(by_names.items(), key=lambda item: -len(item[0])))


def _words(measures: Sequence[str]) -> str:
    return joined([runs.measure_words(measure) for measure in measures])


def _off(
    run: Run, measures: Sequence[str], names: Sequence[str], every: Sequence[str], far: Score | None
) -> str:
    """Measures that the same engines miss, and the farthest value where it is among them."""
    text = f"{_words(measures)} in {engines(names, every)}"
    if far is None or far.measure not in measures or far.source not in names:
        return text
    off = numbers.with_u(
        abs((far.value or 0.0) - (far.truth or 0.0)), far.scatter, far.unit, far.truth, 2
    )
    which = [] if len(measures) == 1 else [runs.measure_words(far.measure)]
    which += [] if len(names) == 1 else [f"in {far.source}"]
    share = numbers.plain(runs.share_of_tolerance(run, far), 2)
    told = " ".join(["the farthest:", *which, f"off by {off}, {share} times the tolerance"])
    return f"{text} ({told})"


def _failed(run: Run, name: str, mode: str, measure: str, *, known: bool) -> bool:
    score = runs.score_of(run, name, mode, measure)
    return score is not None and score.verdict == FAIL and (score.value is not None) == known


def _unmeasured(run: Run, name: str, mode: str) -> list[Score | None]:
    """What has a tolerance and was neither met nor missed: there is nothing to judge."""
    scores = [runs.score_of(run, name, mode, measure) for measure in runs.judged(run)]
    return [one for one in scores if one is None or one.verdict not in (PASS, FAIL)]


def _met(run: Run, name: str, mode: str, unmeasured: Sequence[Score | None]) -> str:
    """How many tolerances a source met where not all could be judged, and why not."""
    met, _ = runs.passed(run, name, mode)
    count, of = len(unmeasured), len(runs.judged(run))
    were = "was" if count == 1 else "were"
    reasons = "; ".join(dict.fromkeys(one.lacking for one in unmeasured if one and one.lacking))
    why = f" ({reasons})" if reasons else ""
    are = "is" if met == 1 else "are"
    return f"in {name} {met} of {of} {are} right, {count} {were} not measured{why}"


def _farthest(run: Run, mode: str) -> Score | None:
    """The value that is farthest from the truth, in tolerances; ``None`` where all are within.

    What was missed may be what could not be measured.
    """
    scores = [
        score
        for measure in runs.judged(run)
        for name in runs.names(run)
        if (score := runs.score_of(run, name, mode, measure)) is not None
    ]
    shares = [runs.share_of_tolerance(run, score) or 0.0 for score in scores]
    share = max(shares, default=0.0)
    return scores[shares.index(share)] if share > 1 else None


def _not_run(run: Run) -> list[str]:
    """Engines that did not run at any level, and those that ran at some, by what became of them."""
    by_name = grouped((source.name, source) for source in run.record.sources)
    heads = grouped(
        (_head(sources), (status, name))
        for name, sources in by_name.items()
        for status in dict.fromkeys(source.status for source in sources if not source.ran)
    )
    sentences = []
    for head, pairs in heads.items():
        phrases = [f"{joined(sorted(n))} ({status})" for status, n in grouped(pairs).items()]
        sentences.append(f"{head}: {'; '.join(phrases)}.")
    return sentences


def _head(sources: Sequence[SourceRecord]) -> str:
    """At which levels an engine did not run."""
    missing = [source for source in sources if not source.ran]
    if len(missing) == len(sources):
        return "Did not run"
    return f"Not run {joined([runs.mode_words(source.contact) for source in missing])}"
