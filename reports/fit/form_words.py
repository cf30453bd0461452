"""What a reader must know of closed forms, in sentences: priors, bounds, scatter, rivals."""

from __future__ import annotations

import math
from collections.abc import Sequence

from simcompare.reports.fit.identifiability_words import called
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_forms import REFERENCE_M_S, Candidate, Choice, Form, Prior

#: a prior this many standard uncertainties from what the data say contradicts them
CONTRADICTION = 3.0
#: above the least criterion by less than this: the data cannot tell; by more than that: excluded
RIVAL, EXCLUDED = 4.0, 10.0
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
    value = _inf(first.score(found.criterion))
    words = [f"best model: {first.text} ({found.criterion} {value:.1f}, weight {first.weight:.0%})"]
    if not rest:
        words = [f"model: {first.text}"]
    words += _ambiguous(found, best)
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


def _restitution(one: Candidate) -> float | None:
    row = one.parameters.get("restitution")
    return None if row is None else row.value


def _rivals(found: Choice) -> list[Candidate]:
    """Closed forms that fit about as well as the chosen one."""
    return [c for c in found.candidates[1:] if _inf(c.delta) < RIVAL and c.weight > 0]


def _ambiguous(found: Choice, best: Form) -> list[str]:
    """What the data leave undecided, and what would decide it."""
    rivals = _rivals(found)
    if not rivals:
        return []
    who = "this fits" if len(rivals) == 1 else "these fit"
    words = [f"{who} about as well: {'; '.join(c.text for c in rivals)}"]
    known, own = _restitutions(rivals), _restitutions(found.candidates[:1])
    if known and own and _ends(own) == _ends(known):
        words.append(f"the restitution is the same in all of them, {_ends(known)}")
    elif known:
        words.append(f"their restitution is {_ends(known)}")
    return [*words, *cure(found, best)]


def _restitutions(among: Sequence[Candidate]) -> list[float]:
    return [value for c in among if (value := _restitution(c)) is not None]


def _ends(known: Sequence[float]) -> str:
    return phrases.ends(f"{min(known):.4f}", f"{max(known):.4f}")


def disagreement(found: Choice, best: Form) -> tuple[str, ...]:
    """What closed forms that fit as well give, where that is beyond the 95 % of the chosen one.

    Args:
        found: all closed forms.
        best: the chosen one.
    """
    rivals, row = _rivals(found), best.parameters.get("restitution")
    known = _restitutions(rivals)
    if not known or row is None:
        return ()
    low, high = row.limits
    if (low is None or low <= min(known)) and (high is None or max(known) <= high):
        return ()
    at = f" at {REFERENCE_M_S:g} m/s" if any(c.law != "constant" for c in rivals) else ""
    who = "Another model fits as well and gives" if len(rivals) == 1 else (
        "Other models fit as well and give")  # fmt: skip
    return (f"{who} {_ends(known)}{at}.",)


def cure(found: Choice, best: Form) -> tuple[str, ...]:
    """What would tell apart closed forms that fit equally well.

    Args:
        found: all closed forms.
        best: the chosen one.
    """
    among = [found.candidates[0], *_rivals(found)]
    if _SPEED in best.fixed or _SPEED in best.priors or len({c.drag for c in among}) == 1:
        return ()
    by_speed = any(c.law != "constant" for c in among)
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
