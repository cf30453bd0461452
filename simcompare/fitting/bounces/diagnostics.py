"""What a reader of a fit must be told: priors that contradict the data, bounds, scatter, limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.problem import Problem
from simcompare.fitting.bounces.profile import Profile
from simcompare.fitting.bounces.unknowns import SPEED, base, shown

#: a prior this many standard uncertainties from what the data say contradicts them
CONTRADICTION = 3.0
#: s² above which the scatter is told
_SCATTERED = 2.0


def completed(fit: Fit, problem: Problem, profiles: Mapping[str, Profile] | None) -> Fit:
    """The fit with profiled intervals, pulls of the priors and warnings."""
    profiles = profiles or {}
    intervals, how = list(fit.intervals), list(fit.how)
    for k, name in enumerate(fit.names):
        if name in profiles:
            intervals[k] = (profiles[name].low, profiles[name].high)
            how[k] = "profile"
    pulls = {name: pull(fit, name) for name in problem.priors}
    fit = replace(fit, intervals=tuple(intervals), how=tuple(how), pulls=pulls)
    said = [*_priors(fit), *_bounds(fit), *_scatter(fit), *_open(fit, profiles)]
    return replace(fit, warnings=tuple(said))


def pull(fit: Fit, name: str) -> float:
    """(estimate - prior)/√(u_prior² - u²): a standard normal number where prior and data agree.

    It is the difference between the prior and what the data say without it, over the root sum of
    squares of their uncertainties; 0 where the data say nothing.
    """
    k = fit.names.index(name)
    index, mean, u = fit.problem.prior_rows
    at = index.tolist().index(k)
    left = float(u[at] ** 2 - fit.sought_covariance[k, k])
    if left <= 1e-9 * u[at] ** 2:
        return 0.0
    found = float(fit.x[k] - mean[at]) / math.sqrt(left)
    return -found if base(name) == SPEED else found


def _priors(fit: Fit) -> list[str]:
    said = []
    for name, size in fit.pulls.items():
        if abs(size) > CONTRADICTION:
            prior = fit.problem.priors[name]
            k = fit.names.index(name)
            side = "above" if size > 0 else "below"
            said.append(
                f"the prior {prior.value:g} ± {prior.u:g} of {name} contradicts the data, which"
                f" lie {abs(size):.1f} standard uncertainties {side} it (the fit took"
                f" {fit.values[k]:.5g} as a compromise): correct the prior, or look for what the"
                " model leaves out"
            )
    return said


def _bounds(fit: Fit) -> list[str]:
    said = []
    for name in fit.at_bound:
        k = fit.names.index(name)
        at = float(shown(name, fit.x[k]))
        if base(name) == SPEED and math.isinf(at):
            low = fit.intervals[k][0]
            said.append(
                "no drag is seen: the data fit best without it"
                + (f", and a terminal speed below {low:.3g} m/s is excluded" if low > 0 else "")
            )
        else:
            said.append(f"{name} ended at {at:g}, the limit of what it can physically be: the model"
                        " does not describe these data")  # fmt: skip
    return said


def _scatter(fit: Fit) -> list[str]:
    from scipy import stats

    if not fit.problem.u_known:
        return ["the uncertainty of the measurements is not stated; it was taken from their"
                f" scatter about the model ({fit.dof} degrees of freedom)"]  # fmt: skip
    if fit.dof == 0:
        return ["as many unknowns as measured numbers: nothing is left that could show that the"
                " model does not fit"]  # fmt: skip
    if fit.s2 > _SCATTERED and stats.chi2.sf(fit.s2 * fit.dof, fit.dof) < 0.01:
        return [
            f"the data scatter {math.sqrt(fit.s2):.1f} times as much about this model as their"
            " uncertainties say; intervals were widened by that, but another model may be needed"
        ]
    return []


def _open(fit: Fit, profiles: Mapping[str, Profile]) -> list[str]:
    """Unknowns that the data leave open on one side or both."""
    said = []
    for name, found in profiles.items():
        low, high = found.open_low, found.open_high
        if base(name) == SPEED:
            high = False  # no drag at all is an answer, not an open end
        if low and high:
            said.append(f"{name} is not identifiable from these data: every value that was tried"
                        " fits as well; fix it or give a prior")  # fmt: skip
        elif (low or high) and name not in fit.at_bound:
            side = "below" if low else "above"
            said.append(f"{name} has no limit {side}: the data fit there as well; a prior would"
                        " give one")  # fmt: skip
    return said
