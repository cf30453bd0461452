"""What a fit of bounces says, in sentences: first what to type into a loop of one's own."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

from simcompare.notation import sentence
from simcompare.reports.fit import form_words, identifiability_words
from simcompare.reports.fit.fits import interval
from simcompare.results.records.fit_bounces import BouncesFit, Drop
from simcompare.results.records.fit_forms import OtherEstimate
from simcompare.results.records.fit_holdout import Holdout

#: significant digits of a number that is typed in; more than its uncertainty knows
_DIGITS = 7
_RULES = {
    "mean ratio": "mean ratio of neighbouring flights, weighted",
    "first ratio": "first ratio alone",
    "line": "line through the logarithms of the flights",
    "trajectory": "least squares of the whole trajectory",
}


def worded(fit: BouncesFit) -> BouncesFit:
    """The record of a fit with all its sentences."""
    closed, form = fit.closed_form, fit.engine_form
    closed = replace(closed, warnings=form_words.warnings(closed))
    filmed = any(drop.samples for drop in fit.measured)
    known = identifiability_words.of_bounces(fit.identifiability, closed.priors, filmed=filmed)
    found = replace(
        fit,
        dropped=tuple(text for drop in fit.measured for text in dropped(drop)),
        closed_form=closed,
        engine_form=form and replace(form, warnings=form_words.warnings(form)),
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
        word = "impact" if len(drop.missed) == 1 else "impacts"
        numbers = ", ".join(str(n) for n in drop.missed)
        words.append(f"{word} {numbers} not recorded: a flight there lasts too long for one")
    return [*words, *drop.notes]


def _sentences(fit: BouncesFit) -> list[str]:
    """The answer, and what must be known of it."""
    words = _typed(fit)
    best = fit.closed_form.parameters.get("restitution")
    if best is not None and best.value is not None:
        low, high = interval(best)
        slow, fast = fit.valid.speed_m_s
        words.append(
            f"The restitution is {_digits(best.value, high - low)}, with 95 % between"
            f" {_digits(low, high - low)} and {_digits(high, high - low)}"
            f" ({fit.closed_form.text}; impacts at {slow:.2f} to {fast:.2f} m/s)."
        )
    form = fit.engine_form
    if form is not None:
        words.append(
            f"Engines have no such law; they were fitted with {form.text}, which leaves"
            f" χ² = {form.chi2:.3g} for {form.count} numbers."
        )
    words += _shown(fit)
    words += [sentence(text) for text in (*fit.choice.words, *fit.identifiability.words)]
    words += [sentence(text) for text in fit.closed_form.warnings]
    return [*words, fit.holdout.text]


def _typed(fit: BouncesFit) -> list[str]:
    """What to type in, engine by engine."""
    lines = []
    for source in fit.sources:
        if source.numbers:
            numbers = ", ".join(
                f"{row.name} = {row.value:.{_DIGITS}g}"
                + ("" if row.unit in ("", "1") else f" {row.unit}")
                for row in source.numbers
            )
            lines.append(f"{source.name}: {numbers}")
    goal = fit.tuned_to
    if goal is None or not lines:
        return []
    return [
        f"Type these into a loop with a step of {1e3 * fit.valid.engine_step_s:.4g} ms:"
        f" {'; '.join(lines)}. Then an impact at {goal.speed_m_s:.2f} m/s has on average the"
        f" restitution {_digits(goal.restitution, 4 * goal.u)} that was"
        f" {'measured' if goal.u else 'given'}."
    ]


def _shown(fit: BouncesFit) -> list[str]:
    """How far engines are from each other, and from a law that they do not have."""
    shown = [s.effective["restitution"].value for s in fit.sources if s.effective]
    words = []
    if len(shown) > 1:
        spread = (max(shown) - min(shown)) / (sum(shown) / len(shown))
        how = "In their plain loops" if fit.is_tuned else "Fitted to it"
        words.append(
            f"{how}, {len(shown)} engines show mean restitutions that differ by"
            f" {100 * spread:.3f} %."
        )
    law = next(c.law for c in fit.choice.candidates if c.model == fit.closed_form.model)
    if fit.is_tuned and shown and law != "constant":
        worst = max((row.deviation for s in fit.sources for row in s.impacts), key=abs)
        words.append(
            "Engines have one restitution for all speeds; theirs is that of the first impact, and"
            f" at later ones it is up to {100 * abs(worst):.2g} % off."
        )
    return words


def _digits(value: float, width: float) -> str:
    """A number to a hundredth of an interval, at least four decimals."""
    places = 4 if not 0 < width < math.inf else max(4, 2 - math.floor(math.log10(width)))
    return f"{value:.{min(places, 9)}f}"


def _holdout(fit: BouncesFit) -> str:
    """How many of the drops that were not fitted are predicted."""
    if not fit.holdout.drops:
        return "No drop was held out, so nothing was validated."
    judged = [drop.e_n for drop in fit.holdout.drops if drop.e_n is not None]
    text = (
        f"{_good(judged)} of {len(judged)} held-out drops agree with the fitted restitution within"
        " the noise level (|E_n| ≤ 1, k = 2)."
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
    return (
        f" Rebound heights predicted within it: {', '.join(counts)}. Impact times stand beside"
        " them and are not judged in plain loops, since they hold the time of the contact."
    )


def _other(row: OtherEstimate) -> OtherEstimate:
    """A restitution by another rule, with what is wrong with that rule."""
    texts = {
        "mean ratio": f"no height and no clock matters; drag biases it. {trend(row)}",
        "first ratio": "one bounce only",
        "line": "every flight counts alike, long and short ones",
        "trajectory": f"residuals jump where impacts move: {row.reached} of {row.starts} starts"
        " reached the minimum",
    }
    return replace(row, name=_RULES[row.rule], text=texts[row.rule])


def trend(row: OtherEstimate) -> str:
    """What ratios of flights that rise or fall from impact to impact say."""
    change, u = row.trend, row.u_trend
    if change is None or u is None or abs(change) < 3 * u:
        return "the ratios of flights show no trend"
    if change > 0:
        return (f"the ratios of flights rise by {change:.2g} from impact to impact: the mark of air"
                " drag, or of a restitution that falls with speed")  # fmt: skip
    return (f"the ratios of flights fall by {-change:.2g} from impact to impact: neither drag nor a"
            " restitution that falls with speed does that; look at the last impacts, where the"
            " ball may have rolled or the sounds run together")  # fmt: skip
