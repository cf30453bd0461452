"""A closed form fitted to drops: the estimate, its intervals, and what its reader must know."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from simcompare.fitting.bounces import bounce_models, initial_guess, profile
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import Fit, Profile, minimum, spread, summary
from simcompare.fitting.bounces.problem import Problem, build
from simcompare.fitting.bounces.unknowns import SPEED, base
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_forms import Prior
from simcompare.statistics import least_squares

#: part of its prior's uncertainty that is no move of an unknown
_ROUNDING = 1e-5


def fit(
    drops: Impacts | Sequence[Impacts],
    model: str = "constant",
    *,
    unknowns: Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    priors: Mapping[str, Prior] | None = None,
    profiles: bool = True,
) -> Fit:
    """Fits a closed form to one drop or to several together.

    Args:
        drops: what was measured.
        model: name of the model.
        unknowns: what is fitted; by default all of the model, and the height and release time of
            each drop.
        fixed: values of what is not fitted, such as gravity_m_s2 or terminal_speed_m_s.
        priors: what is known of unknowns.
        profiles: whether intervals are profiled where the normal ones may be wrong.

    Raises:
        InputError: every fault of the request, or too few numbers for the unknowns.
    """
    whole = build(
        [drops] if isinstance(drops, Impacts) else list(drops),
        bounce_models.model_of(model), unknowns=unknowns, fixed=fixed, priors=priors,
    )  # fmt: skip
    first = initial_guess.of(whole)
    s2, dof, near = _scatter(whole, first)
    scaled = whole.widened(spread(whole, s2, dof))
    best = _settled(scaled, minimum(scaled, near))
    found = summary(whole, scaled, best, s2, dof)
    pulls = {name: _pull(found, name) for name in scaled.priors}
    profiled = profile.intervals(found, scaled) if profiles else {}
    return _with_profiles(replace(found, pulls=pulls), profiled)


def _scatter(problem: Problem, start: Array) -> tuple[float, int, Array]:
    """s² and its degrees of freedom, without stated priors where there are enough data.

    And the internal numbers that it was taken at, from which the best ones are not far.
    """
    judged = problem.firm if problem.firm.freedom > 0 else problem
    dof = judged.freedom
    if dof == 0:
        return 1.0, 0, start
    found = minimum(judged, start)
    ratio = float(found.chi2[0]) / dof
    return (max(1.0, ratio) if problem.u_known else max(ratio, 1e-12)), dof, found.x[0]


def _settled(problem: Problem, best: least_squares.Solution) -> least_squares.Solution:
    """The same with unknowns that only rounding has moved away from their priors put back.

    The others follow along the valley.
    """
    index, mean, u = problem.prior_rows
    off = mean - best.x[0, index]
    back = np.abs(off) < _ROUNDING * u
    covariance = least_squares.covariance_of(best.jacobian[0], best.at_bound[0] != 0)
    there, off = index[back], off[back]
    moved = covariance[:, there] @ np.linalg.lstsq(covariance[np.ix_(there, there)], off)[0]
    x = np.clip(best.x + moved, problem.low, problem.high)
    x[0, there] = mean[back]
    return replace(best, x=x)


def _with_profiles(fit: Fit, profiles: Mapping[str, Profile]) -> Fit:
    """The fit with profiled intervals in place of normal ones."""
    intervals, how = list(fit.intervals), list(fit.how)
    for k, name in enumerate(fit.names):
        if name in profiles:
            intervals[k] = (profiles[name].low, profiles[name].high)
            how[k] = "profile"
    return replace(fit, intervals=tuple(intervals), how=tuple(how), profiles=profiles)


def _pull(fit: Fit, name: str) -> float:
    """(estimate - prior)/√(u_prior² - u²): a standard normal number where prior and data agree.

    It is the difference between the prior and what the data say without it, over the root sum of
    squares of their uncertainties; 0 where the data say nothing.
    """
    k = fit.names.index(name)
    index, mean, u = fit.problem.prior_rows
    at = index.tolist().index(k)
    left = float(u[at] ** 2 - fit.internal_covariance[k, k])
    if left <= 1e-9 * u[at] ** 2:
        return 0.0
    found = float(fit.x[k] - mean[at]) / math.sqrt(left)
    return -found if base(name) == SPEED else found
