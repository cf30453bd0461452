"""Which closed form the data ask for, with the numbers shown.

AIC = χ² + 2k, AICc = AIC + 2k(k + 1)/(n - k - 1) and BIC = χ² + k·ln n (K. P. Burnham and D. R.
Anderson, Model Selection and Multimodel Inference, 2nd ed., Springer 2002). The correction for few
data belongs to a variance that is estimated from them (C. M. Hurvich and C.-L. Tsai, Biometrika 76
(1989) 297), so AICc decides where no uncertainty is stated or the scatter exceeds it, AIC where the
stated uncertainties hold. χ² is divided by the scatter of the richest model where that exceeds the
stated uncertainties, so that underestimated noise does not ask for more unknowns. An unknown with a
prior counts by the part that the data determine.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from simcompare.errors import InputError
from simcompare.fitting.bounces.bounce_models import MODELS, Model, model_of
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.problem import usual
from simcompare.fitting.bounces.unknowns import Prior

#: above the least criterion by less than this: the data cannot tell; by more than that: excluded
RIVAL, EXCLUDED = 4.0, 10.0
#: scatter that is told has at most this chance where the stated uncertainties hold
_BY_CHANCE = 0.01


@dataclass(frozen=True)
class Candidate:
    """One model and how well it does.

    Attributes:
        model: its name.
        fit: its fit, without profiles unless it was chosen.
        unknowns: k, how many unknowns the data determine.
        chi2: of the data, divided by the common scatter.
        aic: Akaike's criterion, for known uncertainties.
        aicc: the same corrected for few data; infinite where there are too few for the model.
        bic: Schwarz's criterion.
        delta: the deciding criterion above the least.
        weight: Akaike weight among the candidates; 0 for one that repeats another because its
            drag vanished.
    """

    model: str
    fit: Fit
    unknowns: float
    chi2: float
    aic: float
    aicc: float
    bic: float
    delta: float
    weight: float


@dataclass(frozen=True)
class Choice:
    """All candidates, best first, and what they say.

    Attributes:
        candidates: best first.
        criterion: which decided, "AIC" or "AICc".
        scatter: what χ² was divided by.
        refused: model -> why it could not be fitted.
        words: what a reader must know, one sentence each.
    """

    candidates: tuple[Candidate, ...]
    criterion: str
    scatter: float
    refused: Mapping[str, str]
    words: tuple[str, ...]

    @property
    def best(self) -> Fit:
        """Fit of the chosen model."""
        return self.candidates[0].fit

    @property
    def rivals(self) -> tuple[Candidate, ...]:
        """Models that the data cannot tell from the best one."""
        return tuple(c for c in self.candidates[1:] if c.delta < RIVAL and _is_own(c))

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "chosen": self.candidates[0].model,
            "criterion": self.criterion,
            "scatter": self.scatter,
            "words": list(self.words),
            "refused": dict(self.refused),
            "candidates": [
                {
                    "model": c.model, "text": MODELS[c.model].text, "unknowns": c.unknowns,
                    "chi2": c.chi2, "aic": c.aic, "aicc": c.aicc if math.isfinite(c.aicc) else None,
                    "bic": c.bic, "delta": c.delta if math.isfinite(c.delta) else None,
                    "weight": c.weight,
                    "parameters": {
                        name: {k: v if math.isfinite(v) else None
                               for k, v in (("value", float(value)), ("u", float(u)))}
                        for name, value, u in zip(c.fit.names, c.fit.values, c.fit.u, strict=True)
                    },
                }
                for c in self.candidates
            ],
        }  # fmt: skip


def compare(
    drops: Impacts | Sequence[Impacts],
    models: Sequence[str] = tuple(MODELS),
    *,
    extra: Sequence[str] = (),
    fixed: Mapping[str, float] | None = None,
    priors: Mapping[str, Prior] | None = None,
) -> Choice:
    """Fits every model to the same data and weighs them.

    Args:
        drops: what was measured.
        models: names of the candidates.
        extra: unknowns beside those that a fit has by default, such as clock_skew.
        fixed: values of what is not sought; what is fixed is no unknown of any model.
        priors: what is known of unknowns.

    Raises:
        InputError: no model can be fitted.
    """
    every = [drops] if isinstance(drops, Impacts) else list(drops)
    held = dict(fixed or {})
    fits: dict[str, Fit] = {}
    refused: dict[str, str] = {}
    for name in models:
        wanted = {k: v for k, v in (priors or {}).items()}
        asked = [n for n in _usual(every, model_of(name), extra) if n not in held]
        try:
            fits[name] = fit(
                every, name, unknowns=asked, fixed=held, priors=wanted,
                profiles=False,
            )  # fmt: skip
        except InputError as error:
            refused[name] = "; ".join(error.faults)
    if not fits:
        raise InputError("fit", list(dict.fromkeys(refused.values())))
    scatter = _scatter(list(fits.values()))
    stated = scatter == 1.0 and all(drop.u_known for drop in every)
    candidates = _weighed(fits, scatter, stated)
    best = candidates[0]
    asked = list(best.fit.names) if len(every) == 1 else _usual(every, model_of(best.model), extra)
    profiled = fit(
        every, best.model, unknowns=[n for n in asked if n not in held], fixed=held,
        priors=dict(priors or {}),
    )  # fmt: skip
    rest = candidates[1:]
    chosen = replace(best, fit=profiled)
    criterion = "AIC" if stated else "AICc"
    words = _words([chosen, *rest], criterion, scatter, held)
    return Choice((chosen, *rest), criterion, scatter, refused, tuple(words))


def _usual(drops: Sequence[Impacts], model: Model, extra: Sequence[str]) -> list[str]:
    return [*usual(drops, model), *extra]


def _scatter(fits: Sequence[Fit]) -> float:
    """What the richest model that can show any scatter has left, at least 1 where u is stated.

    Scatter that chance explains is none.
    """
    from scipy import stats

    able = [one for one in fits if one.dof > 0]
    if not able:
        return 1.0
    richest = max(able, key=lambda one: (len(one.names), -one.chi2))
    by_chance = stats.chi2.sf(richest.s2 * richest.dof, richest.dof) > _BY_CHANCE
    return 1.0 if richest.problem.u_known and by_chance else richest.s2


def _weighed(fits: Mapping[str, Fit], scatter: float, stated: bool) -> list[Candidate]:
    rows = []
    for name, one in fits.items():
        k, n, chi2 = one.effective, one.count, one.chi2 / scatter
        left = n - k - 1
        aic = chi2 + 2 * k
        aicc = aic + 2 * k * (k + 1) / left if left > 1e-6 else math.inf
        rows.append(Candidate(name, one, k, chi2, aic, aicc, chi2 + k * math.log(n), 0.0, 0.0))
    # too few data for AICc of any model: AIC has to do
    plain = stated or all(math.isinf(row.aicc) for row in rows)
    scores = [row.aic if plain else row.aicc for row in rows]
    least = min(scores)
    shares = [
        math.exp(-(score - least) / 2) if _is_own(row) else 0.0
        for row, score in zip(rows, scores, strict=True)
    ]
    total = sum(shares) or 1.0
    found = [
        replace(row, delta=score - least, weight=share / total)
        for row, score, share in zip(rows, scores, shares, strict=True)
    ]
    # of equals the model with fewer unknowns, such as one whose drag vanished
    return sorted(found, key=lambda c: (round(c.delta, 6), len(c.fit.names)))


def _is_own(candidate: Candidate) -> bool:
    """Whether a model is one of its own: with a vanished drag it is that without drag again."""
    return not candidate.fit.at_bound


def _words(
    rows: Sequence[Candidate], criterion: str, scatter: float, held: Mapping[str, float]
) -> list[str]:
    best = rows[0]
    rivals = [c for c in rows[1:] if c.delta < RIVAL and _is_own(c)]
    said = [
        f"{MODELS[best.model].text} describes the data best ({criterion}"
        f" {best.aic if criterion == 'AIC' else best.aicc:.1f}, Akaike weight {best.weight:.0%})"
    ]
    if rivals:
        said.append(_ambiguous(best, rivals, held))
    simple = next((c for c in rows if c.model == "constant"), None)
    if simple is not None and simple is not best and simple.delta > EXCLUDED:
        said.append(_left_out(best, simple))
    by_bic = min(rows, key=lambda c: c.bic)
    if by_bic is not best and by_bic.bic < best.bic - 1e-6:
        said.append(f"the BIC would choose {MODELS[by_bic.model].text} instead"
                    f" ({by_bic.bic:.1f} against {best.bic:.1f})")  # fmt: skip
    if scatter > 2 and best.fit.problem.u_known:
        said.append(
            f"even the richest model leaves residuals {math.sqrt(scatter):.1f} times as large as"
            " the stated uncertainties: these are too small, or something else is at work"
        )
    return said


def _ambiguous(best: Candidate, rivals: Sequence[Candidate], held: Mapping[str, float]) -> str:
    """What the data leave undecided, and what would decide it."""
    names = ", ".join(f"{MODELS[c.model].text} (ΔAIC {c.delta:.1f})" for c in rivals)
    values = [c.fit.as_dict().get("restitution", math.nan) for c in (best, *rivals)]
    known = [v for v in values if math.isfinite(v)]
    spread = ""
    if known:
        spread = f"; the restitution is {min(known):.4f} to {max(known):.4f} among them"
    among = [model_of(c.model) for c in (best, *rivals)]
    only_drag = any(m.drag and m.law == "constant" for m in among)
    only_law = any(m.law != "constant" and not m.drag for m in among)
    if only_drag and only_law and "terminal_speed_m_s" not in held:
        return (
            "the data cannot tell drag from velocity dependence: give the terminal speed. About as"
            f" good: {names}{spread}"
        )
    if all(_extends(model_of(c.model), model_of(best.model)) for c in rivals):
        return f"nothing in the data asks for more, and they do not exclude it: {names}{spread}"
    return f"the data cannot tell it from: {names}{spread}"


def _extends(model: Model, simple: Model) -> bool:
    """Whether a model is the simple one with more unknowns."""
    same = model.law == simple.law or (simple.law == "constant" and model.law == "power")
    return same and set(simple.own) < set(model.own)


def _left_out(best: Candidate, simple: Candidate) -> str:
    """What a constant restitution without drag would have said."""
    text = f"constant restitution without drag is excluded (ΔAIC {simple.delta:.0f})"
    ours, theirs = (c.fit.as_dict().get("restitution") for c in (best, simple))
    if ours is None or theirs is None:
        return text
    off = 100 * (theirs / ours - 1)
    return f"{text}; it would give a restitution of {theirs:.4f}, {off:+.1f} % off"
