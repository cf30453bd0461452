"""What a reader must know of closed forms, in sentences: priors, bounds, scatter, rivals."""

from __future__ import annotations

import math

from simcompare.reports.fit.identifiability_words import called
from simcompare.results.records.fit_forms import Candidate, Choice, Form, Prior

#: a prior this many standard uncertainties from what the data say contradicts them
CONTRADICTION = 3.0
#: above the least criterion by more than this: excluded
EXCLUDED = 10.0
_SPEED = "terminal_speed_m_s"


def warnings(form: Form) -> tuple[str, ...]:
    """What a reader of a fitted form must know."""
    return (*_priors(form), *_bounds(form), *_scatter(form), *_open(form))


def _priors(form: Form) -> list[str]:
    words = []
    for name, pull in form.pulls.items():
        if pull is not None and abs(pull) > CONTRADICTION:
            words.append(_contradiction(name, form.priors[name], pull))
    return words


def _contradiction(name: str, prior: Prior, pull: float) -> str:
    side = "above" if pull > 0 else "below"
    off = f"which lie {abs(pull):.1f} standard uncertainties {side} it"
    if prior.reason:
        return (f"the {called(name)} was assumed to be {prior.value:.4g} ± {prior.u:.2g}, which"
                f" contradicts the data, {off}: measure it, or give it with --prior")  # fmt: skip
    return (f"the prior {prior.value:g} ± {prior.u:g} of {called(name)} contradicts the data,"
            f" {off}: correct the prior")  # fmt: skip


def _bounds(form: Form) -> list[str]:
    words = []
    for name in form.at_bound:
        row = form.parameters[name]
        if name == _SPEED and row.value is None:
            words.append(
                "no air drag is seen"
                + (f": the terminal speed is above {row.low:.3g} m/s" if row.low else "")
            )
        else:
            words.append(f"the {called(name)} ended at its limit, {_inf(row.value):g}: the model"
                         " does not describe these data")  # fmt: skip
    return words


def drag(found: Choice, best: Form) -> tuple[str, ...]:
    """What is said where laws without the drag of the settings are much better."""
    if found.drag_excess is None or found.drag_excess <= EXCLUDED:
        return ()
    prior = best.priors[_SPEED]
    return (f"the drag of the settings, a terminal speed of {prior.value:.3g} ± {prior.u:.2g} m/s,"
            " contradicts the data: a law without drag describes them much better (its AIC is"
            f" lower by {found.drag_excess:.1f}). Leave the drag out, or give the terminal speed of"
            " your ball with --prior",)  # fmt: skip


def _scatter(form: Form) -> list[str]:
    if not form.u_known:
        return ["the recording states no uncertainty; it was taken from the scatter about the"
                " model"]  # fmt: skip
    if form.dof == 0:
        return ["there are as many unknowns as measured numbers, so nothing can show a wrong"
                " model"]  # fmt: skip
    if form.scattered:
        return [f"the data scatter {math.sqrt(form.s2):.1f} times as much as stated; all intervals"
                " are wider by that"]  # fmt: skip
    return []


def _open(form: Form) -> list[str]:
    """Unknowns that the data leave open on one side or both."""
    words = []
    for name, row in form.parameters.items():
        # no drag at all is an answer, not an open end
        low, high = row.open_low, row.open_high and name != _SPEED
        if low and high:
            words.append(f"the data do not tell the {called(name)}: give it with --fix or --prior")
        elif (low or high) and name not in form.at_bound:
            side = "lower" if low else "upper"
            words.append(f"the data give no {side} limit of the {called(name)}: a --prior would")
    return words


def _inf(value: float | None) -> float:
    return math.inf if value is None else value


def choice(found: Choice, best: Form) -> tuple[str, ...]:
    """Which closed form was chosen, and what the data leave undecided.

    Args:
        found: all closed forms.
        best: the chosen one.
    """
    first, *rest = found.candidates
    words = [_described(found), *cure(found, best)] if rest else [f"model: {first.text}"]
    simple = next((c for c in rest if c.model == "constant"), None)
    if simple is not None and _inf(simple.delta) > EXCLUDED:
        words.append(_left_out(first, simple))
    by_bic = min(found.candidates, key=lambda c: c.bic)
    if by_bic.bic < first.bic - 1e-6:
        words.append(f"another criterion, the BIC, prefers {by_bic.text}")
    if found.scatter > 2 and best.u_known:
        words.append(
            f"even the best model leaves {math.sqrt(found.scatter):.1f} times the stated"
            " uncertainty: that is too small, or something else is at work"
        )
    return tuple(words)


def _described(found: Choice) -> str:
    """The one model that describes the data best, or those among which is a tie."""
    first = found.candidates[0]
    if not found.rivals:
        return f"best model: {first.text} (AIC {first.aic:.1f}, weight {first.weight:.0%})"
    tied = "; ".join(f"{c.text} ({c.weight:.0%})" for c in (first, *found.rivals))
    return f"a tie: these fit about as well, and results are averaged by their weights: {tied}"


def _restitution(one: Candidate) -> float | None:
    row = one.parameters.get("restitution")
    return None if row is None else row.value


def cure(found: Choice, best: Form) -> tuple[str, ...]:
    """What would tell apart closed forms that fit equally well.

    Args:
        found: all closed forms.
        best: the chosen one.
    """
    among = [found.candidates[0], *found.rivals]
    if _SPEED in best.fixed or _SPEED in best.priors or len({c.drag for c in among}) == 1:
        return ()
    # a slope that all of them have is seen, whatever the air does
    by_speed = len({c.law == "constant" for c in among}) > 1
    what = "tell air drag from a restitution that depends on speed" if by_speed else (
        "tell whether the air slows the ball")  # fmt: skip
    return (f"the data cannot {what}: give the terminal speed of your ball, such as"
            " --fix terminal_speed=9m/s",)  # fmt: skip


def _left_out(best: Candidate, simple: Candidate) -> str:
    """What a constant restitution without drag would have said."""
    text = "a constant restitution without drag does not fit"
    ours, theirs = _restitution(best), _restitution(simple)
    if ours is None or theirs is None:
        return text
    off = 100 * abs(theirs / ours - 1)
    side = "high" if theirs > ours else "low"
    return f"{text}; it would give {theirs:.4f}, {off:.1f} % too {side}"
