"""What a fit of bounces says, in sentences."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

from simcompare.notation import sentence
from simcompare.reports.fit import budget, engine_words, fits, form_words, identifiability_words
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_bounces import BouncesFit, Drop
from simcompare.results.records.fit_forms import OtherEstimate
from simcompare.results.records.fit_holdout import Holdout

_RULES = {
    "mean ratio": "mean ratio of flights, weighted",
    "first ratio": "first ratio alone",
    "line": "line through log(flights)",
}


def worded(fit: BouncesFit) -> BouncesFit:
    """The record of a fit with all its sentences."""
    closed = fit.closed_form
    against = form_words.drag(fit.choice, closed)
    closed = replace(closed, warnings=(*against, *form_words.warnings(closed)))
    kinds = {drop.kind for drop in fit.measured}
    recorded = kinds.pop() if len(kinds) == 1 else "recording"
    known = identifiability_words.of_bounces(
        fit.identifiability, closed.priors, recorded, closed.parameters
    )
    found = replace(
        fit,
        dropped=tuple(text for drop in fit.measured for text in dropped(drop)),
        closed_form=closed,
        choice=replace(fit.choice, words=form_words.choice(fit.choice, closed)),
        identifiability=replace(fit.identifiability, words=known),
        holdout=replace(fit.holdout, text=_holdout(fit)),
        other_estimates=tuple(map(_other, fit.other_estimates)),
    )
    return replace(found, sentences=tuple(_sentences(found)))


def dropped(drop: Drop) -> list[str]:
    """What was left out of a drop and what was missed, one sentence each."""
    words = []
    for (what, reason), group in itertools.groupby(drop.dropped, lambda d: (d.what, d.reason)):
        own = list(group)
        first, last = own[0], own[-1]
        words.append(
            f"{what} {first.number} at {first.time_s:.4f} s was left out: {reason}"
            if len(own) == 1
            else f"{len(own)} {what}s from {first.time_s:.4f} to {last.time_s:.4f} s were left"
            f" out: {reason}"
        )
    if drop.missed:
        one = len(drop.missed) == 1
        numbers = phrases.listed([str(n) for n in drop.missed])
        word, verb = ("impact", "was") if one else ("impacts", "were")
        words.append(f"{word} {numbers} {verb} not recorded")
    return [*words, *drop.notes]


def _sentences(fit: BouncesFit) -> list[str]:
    """The answer, and what must be known of it; one fact a sentence."""
    return [
        *_restitution(fit),
        *engine_words.of_engines(fit),
        *(sentence(text) for text in fit.choice.words),
        *(sentence(text) for text in fit.closed_form.warnings),
        *(sentence(text) for text in fit.identifiability.words),
        *budget.words(fit),
        fit.holdout.text,
    ]


def _restitution(fit: BouncesFit) -> list[str]:
    if "restitution" not in fit.closed_form.parameters:
        return []
    return [
        fits.restitution_words(fit),
        f"The fit holds for impacts at {fits.speeds(fit.valid.speed_m_s)} m/s.",
    ]


def _holdout(fit: BouncesFit) -> str:
    """How many of the drops that were not fitted are predicted."""
    if not fit.holdout.drops:
        return "No drop was kept back (--hold-out), so the fit was not tested."
    judged = [drop.e_n for drop in fit.holdout.drops if drop.e_n is not None]
    if not judged:
        text = "The restitution was given, so held-out drops do not test it."
        return text + (_heights(fit.holdout, fit) if fit.is_tuned else "")
    verb = "agrees" if 1 in (_good(judged), len(judged)) else "agree"
    text = (
        f"{_good(judged)} of {phrases.counted(len(judged), 'held-out drop')} {verb} with the"
        " fitted restitution within the uncertainty (|E_n| ≤ 1)."
    )
    return text + (_heights(fit.holdout, fit) if fit.is_tuned else "")


def _good(judged: Sequence[float]) -> int:
    return sum(abs(value) <= 1 for value in judged)


def _heights(holdout: Holdout, fit: BouncesFit) -> str:
    """How many rebound heights are predicted, source by source."""
    names = [source.name for source in fit.sources if source.parameters]
    counts = []
    for name in ("the closed form", *names):
        rows = [drop if name == "the closed form" else drop.engines[name] for drop in holdout.drops]
        judged = [height.e_n for row in rows for height in row.heights if height.e_n is not None]
        if judged:
            counts.append(f"{name} {_good(judged)} of {len(judged)}")
    if not counts or not names:
        return ""
    return f" Rebound heights predicted within the uncertainty: {', '.join(counts)}."


def _other(row: OtherEstimate) -> OtherEstimate:
    """A restitution by another rule, with what is wrong with that rule."""
    texts = {
        "mean ratio": f"needs no height and no clock; air drag makes it too small. {trend(row)}",
        "first ratio": "uses one bounce only",
        "line": "counts short flights as much as long ones",
    }
    return replace(row, name=_RULES[row.rule], text=texts[row.rule])


def trend(row: OtherEstimate) -> str:
    """What ratios of flights that rise or fall from impact to impact say."""
    change, u = row.trend, row.u_trend
    if change is None or u is None or abs(change) < 3 * u:
        return "the ratios of flights show no trend"
    if change > 0:
        return (f"the ratios of flights rise by {change:.2g} each impact: air drag, or a"
                " restitution that falls with speed")  # fmt: skip
    return (f"the ratios of flights fall by {-change:.2g} each impact: look at the last impacts,"
            " where the ball may have rolled")  # fmt: skip
