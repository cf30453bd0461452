"""The answer of a run in plain words, computed from its scores."""

from __future__ import annotations

from simcompare.compare import Score
from simcompare.reports import numbers, runs
from simcompare.results import TRUTH, Run
from simcompare.settings import ASSISTED, DEFAULT, SHOWN_LEVELS, TUNED


def answer(run: Run) -> list[str]:
    """One sentence for each contact level, and one for engines that did not run."""
    sentences = []
    for mode in runs.modes(run):
        sentence = _truthful(run, mode) if runs.judged(run) else _without_truth(run, mode)
        if sentence:
            sentences.append(sentence)
    missing = sorted({row["name"] for row in runs.not_run(run)})
    if missing:
        sentences.append(f"Did not run: {', '.join(missing)}; the reasons are below.")
    if run.interrupted:
        sentences.append("The run was interrupted before it was complete.")
    return sentences


def count_of(part: int, whole: int, noun: str = "engine") -> str:
    """``none of the 4 engines``, ``3 of 4 engines``, ``all 4 engines``, ``the one engine``."""
    if whole == 1:
        return f"the one {noun}" if part else f"not the one {noun}"
    if part == 0:
        return f"none of the {whole} {noun}s"
    return f"all {whole} {noun}s" if part == whole else f"{part} of {whole} {noun}s"


def _truthful(run: Run, mode: str) -> str | None:
    return _as_it_comes(run, mode) if mode in SHOWN_LEVELS else _given(run, mode)


def _as_it_comes(run: Run, mode: str) -> str | None:
    """How near the engines come to the leading measure when nobody tells them all the physics."""
    lead = runs.judged(run)[0]
    scores = _scores(run, mode, lead)
    head = "By default" if mode == DEFAULT else "Given no more than the coefficients,"
    if not scores or scores[0].truth is None:
        return None
    shares = [runs.share_of_tolerance(run, score) for score in scores]
    within = sum(share is not None and share <= 1 for share in shares)
    words, true = runs.measure_words(lead), _number(scores[0].truth, scores[0].unit)
    subject = count_of(within, len(scores))
    one = len(scores) == 1 or within in (0, 1)
    if scores[0].truth == 0:  # an error, of which there should be none
        keeps = "keeps" if one else "keep"
        return f"{head} {subject} {keeps} the {words} within its tolerance{_shown(scores)}."
    comes = "comes" if one else "come"
    return (
        f"{head} {subject} {comes} within the tolerance of the true {words} of {true}"
        f"{_shown(scores)}."
    )


def _given(run: Run, mode: str) -> str | None:
    """How many engines meet every tolerance once they are given the physics, and the worst."""
    names = runs.ran(run, mode)
    if not names:
        return None
    met = [runs.passed(run, name, mode) for name in names]
    number = max((of for _, of in met), default=0)
    agree = sum(got == of and of > 0 for got, of in met)
    what = "the one tolerance" if number == 1 else f"all {number} tolerances"
    how = _HOW.get(mode, f"In the level {mode}")
    if mode == ASSISTED and run.record.get("assist") == "none":
        how = "With none of our helps (assisted)"
    meet = "meets" if len(names) == 1 or agree in (0, 1) else "meet"
    if len(names) == 1 and not agree:
        return f"{how}, the one engine does not meet {what} of the {TRUTH}{_worst(run, mode)}."
    return f"{how}, {count_of(agree, len(names))} {meet} {what} of the {TRUTH}{_worst(run, mode)}."


_HOW = {
    TUNED: "In a plain loop with everything typed in (tuned)",
    ASSISTED: "With our helps (assisted)",
    "fitted": "With parameters fitted to a measurement",
}


def _worst(run: Run, mode: str) -> str:
    scores = [s for measure in runs.judged(run) for s in _scores(run, mode, measure)]
    shares = [(share, s) for s in scores if (share := runs.share_of_tolerance(run, s)) is not None]
    if not shares:
        return ""
    share, score = max(shares, key=lambda pair: pair[0])
    if score.value is None or score.truth is None or share == 0:
        return ""
    off = numbers.with_u(abs(score.value - score.truth), score.u, score.unit, score.truth, 3)
    return (
        f"; the largest deviation is {numbers.percent(share)} of its tolerance:"
        f" {score.source}, {runs.measure_words(score.measure)} off by {off}"
    )


def _without_truth(run: Run, mode: str) -> str | None:
    measures = runs.measures(run)
    scores = _scores(run, mode, measures[0]) if measures else []
    if not scores:
        return None
    words = runs.measure_words(measures[0])
    head = runs.mode_words(mode)
    return (
        f"{head[0].upper()}{head[1:]}, {count_of(len(scores), len(scores))} ran; there is no truth"
        f" to hold the {words} against{_shown(scores)}."
    )


def _shown(scores: list[Score]) -> str:
    values = sorted(score.value for score in scores if score.value is not None)
    if not values:
        return ": no value could be measured"
    missing = [score.source for score in scores if score.value is None]
    none = f"; {' and '.join(missing)} gave none" if missing else ""
    unit = scores[0].unit
    # what is a rounding error of the truth is 0
    truth = abs(scores[0].truth or 0.0)
    low, high = (
        value if abs(value) > numbers.ROUNDING * truth else 0.0 for value in (values[0], values[-1])
    )
    digits = 3 if numbers.plain(low, 3) != numbers.plain(high, 3) else 5
    if numbers.plain(low, digits) == numbers.plain(high, digits):
        return f": the value is {_number(low, unit)}{none}"
    between = f"{numbers.plain(low, digits)} and {_number(high, unit, digits)}"
    return f": the values lie between {between}{none}"


def _number(value: float, unit: str, digits: int = 4) -> str:
    return numbers.plain(value, digits) + ("" if unit in ("", "1") else f" {unit}")


def _scores(run: Run, mode: str, measure: str) -> list[Score]:
    found = [runs.score_of(run, name, mode, measure) for name in runs.names(run)]
    return [score for score in found if score is not None]
