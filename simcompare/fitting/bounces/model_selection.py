"""Which closed form the data ask for, with the numbers shown.

AIC = χ² + 2k where the stated uncertainties hold (K. P. Burnham and D. R. Anderson, Model Selection
and Multimodel Inference, 2nd ed., Springer 2002). Where none is stated, or the scatter exceeds it,
the variance is told by the richest law with its ν degrees of freedom. Akaike's weight exp(-AIC/2),
averaged over what that variance may be, is then (χ²)^(-ν/2)·exp(-k), so AIC = ν·ln(χ²/ν) + 2k. In
simulated tables of 5 to 12 intervals this covers 95 to 97 %; n·ln χ² + 2k covers 92 to 93 %, and
AICc, which makes simple laws win where data are few, 77 to 89 %. BIC has k·ln n in place of 2k. An
unknown with a prior counts by the part that the data determine.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare.errors import InputError
from simcompare.fitting.bounces import distribution
from simcompare.fitting.bounces.bounce_models import MODELS, Model, model_of
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import COVERAGE, Fit, explained
from simcompare.fitting.bounces.problem import usual
from simcompare.fitting.bounces.request import Constraints
from simcompare.fitting.bounces.unknowns import BOUNDS, SPEED, base
from simcompare.results.records.fit_forms import Prior
from simcompare.statistics import least_squares
from simcompare.statistics.identifiability import identifiability

#: half of a 95 % interval beyond which nothing is told: the range of what can be
_WIDEST = {name: BOUNDS[name][1] - BOUNDS[name][0] for name in (
    "restitution", "exponent", "drop_height_m"
)}  # fmt: skip
#: ln of the most that a part of a distribution is multiplied by
_MOST_GAIN = 300.0

#: χ²/ν, beside that of the richest model, below which only rounding is left
_ROUNDING = 1e-3
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
        aic: Akaike's criterion.
        bic: Schwarz's criterion.
        delta: Akaike's criterion above the least.
        weight: Akaike weight among the candidates. One whose drag may be 0 counts by the part of
            its distribution that lies above 0.
    """

    model: str
    fit: Fit
    unknowns: float
    chi2: float
    aic: float
    bic: float
    delta: float
    weight: float


@dataclass(frozen=True)
class Choice:
    """All candidates, best first, and what they say.

    Attributes:
        candidates: best first.
        scatter: what χ² was divided by.
        dof: degrees of freedom of the scatter where it alone tells the uncertainty, else 0.
        refused: model -> why it could not be fitted.
    """

    candidates: tuple[Candidate, ...]
    scatter: float
    dof: int
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
        # what the form with the fewest unknowns needs, all others need too
        sources = ", ".join(dict.fromkeys(drop.source for drop in every if drop.source))
        raise InputError(sources or "fit", [next(iter(refused.values()))])
    scatter, dof = scatter_of(list(fits.values()))
    candidates = _weighed([candidate(name, one, scatter, dof) for name, one in fits.items()])
    best = candidates[0]
    names = list(best.fit.names) if len(every) == 1 else _usual(every, model_of(best.model), extra)
    profiled = fit(
        every, best.model, unknowns=[n for n in names if n not in held], fixed=held,
        priors=priors,
    )  # fmt: skip
    rest = candidates[1:]
    chosen = replace(best, fit=profiled)
    return Choice((chosen, *rest), scatter, dof, refused)


def _usual(drops: Sequence[Impacts], model: Model, extra: Sequence[str]) -> list[str]:
    return list(dict.fromkeys((*usual(drops, model), *extra)))


def _told_apart(found: Fit) -> Fit:
    """The fit itself.

    Raises:
        InputError: data and priors together tell nothing of some combination of its unknowns.
    """
    u = dict(zip(found.names, np.sqrt(np.diag(found.internal_covariance)), strict=True))
    wild = [n for n in found.found if COVERAGE * u[n] > _WIDEST.get(base(n), math.inf)]
    if wild:
        raise InputError("fit", [
            f"the measured numbers tell nothing of {' and '.join(wild)}; correct what is fixed,"
            " state smaller uncertainties where they hold (--u-time, or the u_ column of a table),"
            " or give a prior"
        ])  # fmt: skip
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


def scatter_of(fits: Sequence[Fit]) -> tuple[float, int]:
    """What the richest model that can show any scatter has left, with its degrees of freedom.

    Where u is stated, scatter that chance explains is none: 1 and 0.
    """
    able = [one for one in fits if one.dof > 0]
    if not able:
        return 1.0, 0
    richest = max(able, key=lambda one: (len(one.names), -one.chi2))
    if richest.problem.u_known and explained(richest.s2, richest.dof):
        return 1.0, 0
    return richest.s2, richest.dof


def candidate(name: str, one: Fit, scatter: float, dof: int) -> Candidate:
    """A model with its criteria, not yet weighed."""
    # what a form takes out of what is assumed, such as gravity, is no better fit
    # a drag that ended at 0 was sought as well
    k = one.effective + sum(base(name) == SPEED for name in one.at_bound)
    chi2 = one.chi2 / scatter
    misfit = dof * math.log(max(chi2 / dof, _ROUNDING)) if dof else chi2
    misfit += one.strain
    aic, bic = misfit + 2 * k, misfit + k * math.log(one.count)
    return Candidate(name, one, k, chi2 + one.strain, aic, bic, 0.0, 0.0)


def _weighed(rows: Sequence[Candidate]) -> list[Candidate]:
    """Models with what they are above the best, and their weights; best first."""
    least = min(row.aic for row in rows)
    fair = [math.exp(-(row.aic - least) / 2) for row in rows]
    shares = [_likely(row.fit) * share for row, share in zip(rows, fair, strict=True)]
    if not any(shares):  # all ended at a bound, which is told; none is more likely for that
        shares = fair
    total = sum(shares)
    found = [
        replace(row, delta=row.aic - least, weight=share / total)
        for row, share in zip(rows, shares, strict=True)
    ]
    # of equals the model with fewer unknowns, such as one whose drag vanished
    return sorted(
        found, key=lambda c: (-round(c.weight, 3), round(c.delta, _EQUAL), len(c.fit.names))
    )


def _likely(fit: Fit) -> float:
    """What the weight of a model is multiplied by, because a drag cannot be below 0.

    A model that ended at another bound does not describe the data.
    """
    if any(base(name) != SPEED for name in fit.at_bound):
        return 0.0
    found = distribution.of_fit(fit)
    return found.part * math.exp(min(found.gain / 2, _MOST_GAIN))


def drag_excess(choice: Choice, constraints: Constraints) -> float | None:
    """By how much Akaike's criterion of the best law without drag is below that of the choice.

    Where the restitution may depend on the speed, a slope takes up what a wrong drag of the
    settings does, so that the drag itself is not pulled. Laws without drag then describe the data
    better.

    Args:
        choice: what was chosen with the drag of the settings.
        constraints: with which it was; ``None`` is returned where no drag was assumed.
    """
    prior = constraints.priors.get(SPEED)
    if prior is None or not prior.reason:
        return None
    others = {name: one for name, one in constraints.priors.items() if name != SPEED}
    try:
        airless = compare(
            choice.best.problem.drops, [name for name, one in MODELS.items() if not one.drag],
            extra=constraints.extra, fixed=constraints.fixed, priors=others,
        )  # fmt: skip
    except InputError:
        return None
    both = [row.fit for row in (*choice.candidates, *airless.candidates)]
    scatter, dof = scatter_of(both)
    with_drag, without = (
        min(candidate(row.model, row.fit, scatter, dof).aic
            for row in one.candidates) for one in (choice, airless)
    )  # fmt: skip
    return with_drag - without
