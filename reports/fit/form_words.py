"""What a reader must know of closed forms, in sentences: priors, bounds, scatter, rivals."""

from __future__ import annotations

import math
from collections.abc import Sequence

from simcompare.results.records.fit_forms import Candidate, Choice, Form

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
            prior, value = form.priors[name], form.parameters[name].value
            side = "above" if pull > 0 else "below"
            words.append(
                f"the prior {prior.value:g} ± {prior.u:g} of {name} contradicts the data, which"
                f" lie {abs(pull):.1f} standard uncertainties {side} it (the fit took"
                f" {_inf(value):.5g} as a compromise): correct the prior, or look for what the"
                " model leaves out"
            )
    return words


def _bounds(form: Form) -> list[str]:
    words = []
    for name in form.at_bound:
        row = form.parameters[name]
        if name == _SPEED and row.value is None:
            words.append(
                "no drag is seen: the data fit best without it"
                + (f", and a terminal speed below {row.low:.3g} m/s is excluded" if row.low else "")
            )
        else:
            words.append(
                f"{name} ended at {_inf(row.value):g}, the limit of what it can physically be: the"
                " model does not describe these data"
            )
    return words


def _scatter(form: Form) -> list[str]:
    if not form.u_known:
        return ["the uncertainty of the measurements is not stated; it was taken from their"
                f" scatter about the model ({form.dof} degrees of freedom)"]  # fmt: skip
    if form.dof == 0:
        return ["as many unknowns as measured numbers: nothing is left that could show that the"
                " model does not fit"]  # fmt: skip
    if form.scattered:
        return [
            f"the data scatter {math.sqrt(form.s2):.1f} times as much about this model as their"
            " uncertainties say; intervals were widened by that, but another model may be needed"
        ]
    return []


def _open(form: Form) -> list[str]:
    """Unknowns that the data leave open on one side or both."""
    words = []
    for name, row in form.parameters.items():
        # no drag at all is an answer, not an open end
        low, high = row.open_low, row.open_high and name != _SPEED
        if low and high:
            words.append(f"{name} is not identifiable from these data: every value that was tried"
                         " fits as well; fix it or give a prior")  # fmt: skip
        elif (low or high) and name not in form.at_bound:
            side = "below" if low else "above"
            words.append(f"{name} has no limit {side}: the data fit there as well; a prior would"
                         " give one")  # fmt: skip
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
    words = [
        f"{first.text} describes the data best ({found.criterion} {value:.1f}, Akaike weight"
        f" {first.weight:.0%})"
    ]
    rivals = [c for c in rest if _inf(c.delta) < RIVAL and c.weight > 0]
    if rivals:
        words.append(_ambiguous(found.criterion, first, rivals, drag_is_given=_SPEED in best.fixed))
    simple = next((c for c in rest if c.model == "constant"), None)
    if simple is not None and _inf(simple.delta) > EXCLUDED:
        words.append(_left_out(found.criterion, first, simple))
    by_bic = min(found.candidates, key=lambda c: c.bic)
    if by_bic.bic < first.bic - 1e-6:
        words.append(f"the BIC would choose {by_bic.text} instead"
                     f" ({by_bic.bic:.1f} against {first.bic:.1f})")  # fmt: skip
    if found.scatter > 2 and best.u_known:
        words.append(
            f"even the richest model leaves residuals {math.sqrt(found.scatter):.1f} times as large"
            " as the stated uncertainties: these are too small, or something else is at work"
        )
    return tuple(words)


def _restitution(one: Candidate) -> float | None:
    row = one.parameters.get("restitution")
    return None if row is None else row.value


def _ambiguous(
    criterion: str, best: Candidate, rivals: Sequence[Candidate], *, drag_is_given: bool
) -> str:
    """What the data leave undecided, and what would decide it."""
    names = ", ".join(f"{c.text} (Δ{criterion} {_inf(c.delta):.1f})" for c in rivals)
    among = [best, *rivals]
    known = [value for c in among if (value := _restitution(c)) is not None]
    spread = ""
    if known:
        spread = f"; the restitution is {min(known):.4f} to {max(known):.4f} among them"
    only_drag = any(c.drag and c.law == "constant" for c in among)
    only_law = any(c.law != "constant" and not c.drag for c in among)
    if only_drag and only_law and not drag_is_given:
        return (
            "the data cannot tell drag from velocity dependence: give the terminal speed. About as"
            f" good: {names}{spread}"
        )
    if all(_extends(c, best) for c in rivals):
        return f"nothing in the data asks for more, and they do not exclude it: {names}{spread}"
    return f"the data cannot tell it from: {names}{spread}"


def _extends(form: Candidate, simple: Candidate) -> bool:
    """Whether a form is the simple one with more unknowns."""
    laws = {"constant": {"constant", "power"}}.get(simple.law, {simple.law})
    more = (form.drag, form.law == "power"), (simple.drag, simple.law == "power")
    return form.law in laws and more[0] != more[1] and all(
        ours >= theirs for ours, theirs in zip(*more, strict=True)
    )  # fmt: skip


def _left_out(criterion: str, best: Candidate, simple: Candidate) -> str:
    """What a constant restitution without drag would have said."""
    text = f"constant restitution without drag is excluded (Δ{criterion} {_inf(simple.delta):.0f})"
    ours, theirs = _restitution(best), _restitution(simple)
    if ours is None or theirs is None:
        return text
    off = 100 * (theirs / ours - 1)
    return f"{text}; it would give a restitution of {theirs:.4f}, {off:+.1f} % off"
