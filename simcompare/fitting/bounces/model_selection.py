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

from simcompare.errors import InputError
from simcompare.fitting.bounces import distribution
from simcompare.fitting.bounces.bounce_models import MODELS, Model, model_of
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import BY_CHANCE, Fit
from simcompare.fitting.bounces.problem import usual
from simcompare.fitting.bounces.unknowns import SPEED, base
from simcompare.results.records.fit_forms import Prior
from simcompare.statistics import least_squares
from simcompare.statistics.identifiability import identifiability

#: ln of the most that a part of a distribution is multiplied by
_MOST_GAIN = 300.0

#: decimals of a criterion to which models are equals; priors make its last ones differ
_EQUAL = 1


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
        weight: Akaike weight among the candidates. One whose drag may be 0 counts by the part of
            its distribution that lies above 0.
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
    """

    candidates: tuple[Candidate, ...]
    criterion: str
    scatter: float
    refused: Mapping[str, str]

    @property
    def best(self) -> Fit:
        """Fit of the chosen model."""
        return self.candidates[0].fit


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
        fixed: values of what is not fitted; what is fixed is no unknown of any model.
        priors: what is known of unknowns.

    Raises:
        InputError: no model can be fitted.
    """
    every = [drops] if isinstance(drops, Impacts) else list(drops)
    held = dict(fixed or {})
    fits: dict[str, Fit] = {}
    refused: dict[str, str] = {}
    for name in models:
        names = [n for n in _usual(every, model_of(name), extra) if n not in held]
        try:
            fits[name] = _told_apart(fit(
                every, name, unknowns=names, fixed=held, priors=priors,
                profiles=False,
            ))  # fmt: skip
        except InputError as error:
            refused[name] = "; ".join(error.faults)
    if not fits:
        raise InputError("fit", list(dict.fromkeys(refused.values())))
    scatter = _scatter(list(fits.values()))
    stated = scatter == 1.0 and all(drop.u_known for drop in every)
    rows = [_candidate(name, one, scatter) for name, one in fits.items()]
    # too few data for AICc of any model: AIC has to do
    criterion = "AIC" if stated or all(math.isinf(row.aicc) for row in rows) else "AICc"
    candidates = _weighed(rows, criterion, scatter)
    best = candidates[0]
    names = list(best.fit.names) if len(every) == 1 else _usual(every, model_of(best.model), extra)
    profiled = fit(
        every, best.model, unknowns=[n for n in names if n not in held], fixed=held,
        priors=priors,
    )  # fmt: skip
    rest = candidates[1:]
    chosen = replace(best, fit=profiled)
    return Choice((chosen, *rest), criterion, scatter, refused)


def _usual(drops: Sequence[Impacts], model: Model, extra: Sequence[str]) -> list[str]:
    return [*usual(drops, model), *extra]


def _told_apart(found: Fit) -> Fit:
    """The fit itself.

    Raises:
        InputError: data and priors together tell nothing of some combination of its unknowns.
    """
    problem = found.problem
    jacobian = least_squares.jacobian_of(problem.residuals, found.x[None, :], problem.size)[0]
    known = identifiability(found.names, jacobian)
    if known.is_blind:
        first, *others = known.directions[-1].moves or found.names
        if not others:
            raise InputError("fit", [f"the measured numbers tell nothing of {first}; leave it out,"
                                     " fix it or give a prior"])  # fmt: skip
        mixed = " and ".join((first, *others))
        raise InputError("fit", [
            f"the measured numbers and priors do not tell {mixed} apart; record more"
            " bounces, fix one or give a prior"
        ])  # fmt: skip
    return found


def _scatter(fits: Sequence[Fit]) -> float:
    """What the richest model that can show any scatter has left, at least 1 where u is stated.

    Scatter that chance explains is none.
    """
    from scipy import stats

    able = [one for one in fits if one.dof > 0]
    if not able:
        return 1.0
    richest = max(able, key=lambda one: (len(one.names), -one.chi2))
    by_chance = stats.chi2.sf(richest.s2 * richest.dof, richest.dof) > BY_CHANCE
    return 1.0 if richest.problem.u_known and by_chance else richest.s2


def _candidate(name: str, one: Fit, scatter: float) -> Candidate:
    """A model with its criteria, not yet weighed."""
    # what a form takes out of what is assumed, such as gravity, is no better fit
    # a drag that ended at 0 was sought as well
    k = one.effective + sum(base(name) == SPEED for name in one.at_bound)
    n, chi2 = one.count, one.chi2 / scatter + one.strain
    rest = n - k - 1
    aic = chi2 + 2 * k
    aicc = aic + 2 * k * (k + 1) / rest if rest > 1e-6 else math.inf
    return Candidate(name, one, k, chi2, aic, aicc, chi2 + k * math.log(n), 0.0, 0.0)


def _weighed(rows: Sequence[Candidate], criterion: str, scatter: float) -> list[Candidate]:
    """Models with what they are above the best, and their weights; best first."""
    scores = [row.aic if criterion == "AIC" else row.aicc for row in rows]
    least = min(scores)
    shares = [
        _likely(row, scatter) * math.exp(-(score - least) / 2)
        for row, score in zip(rows, scores, strict=True)
    ]
    total = sum(shares) or 1.0
    found = [
        replace(row, delta=score - least, weight=share / total)
        for row, score, share in zip(rows, scores, shares, strict=True)
    ]
    # of equals the model with fewer unknowns, such as one whose drag vanished
    return sorted(found, key=lambda c: (round(c.delta, _EQUAL), len(c.fit.names)))


def _likely(row: Candidate, scatter: float) -> float:
    """What the weight of a model is multiplied by, because a drag cannot be below 0.

    A model that ended at another bound does not describe the data.
    """
    if any(base(name) != SPEED for name in row.fit.at_bound):
        return 0.0
    found = distribution.of_fit(row.fit)
    return found.part * math.exp(min(found.gain * row.fit.s2 / scatter / 2, _MOST_GAIN))
