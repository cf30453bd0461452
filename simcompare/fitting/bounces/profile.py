"""Profile likelihood: how far one unknown can go while all others make up for it."""

from __future__ import annotations

import numpy as np

from simcompare.fitting.bounces.likelihood import LEVEL, NUISANCE, Fit, Profile
from simcompare.fitting.bounces.problem import Problem
from simcompare.fitting.bounces.unknowns import base, external
from simcompare.model.trajectory import Array
from simcompare.statistics import least_squares

#: correlation above which a normal interval is not trusted
CORRELATED = 0.95
#: part by which Δχ² at ±2 u may differ from 4 before an interval is profiled
_ASYMMETRIC = 0.1
#: places at which the profile is first taken, in standard uncertainties
_PLACES = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
#: farther ones, for a side that does not rise that far
_FAR = (4.0, 6.0, 10.0, 20.0, 40.0)


def intervals(fit: Fit, problem: Problem) -> dict[str, Profile]:
    """Profiles of the unknowns whose normal interval may be wrong."""
    u = np.sqrt(np.diag(fit.internal_covariance))
    rho = _correlation(fit)
    found = {}
    for k, name in enumerate(fit.names):
        if base(name) in NUISANCE or name in fit.assumed:
            continue
        held = u[k] == 0
        if held or rho[k].max() > CORRELATED or _asymmetric(fit, problem, k):
            found[name] = profile(fit, name)
    return found


def _correlation(fit: Fit) -> Array:
    """Sizes of the correlations between unknowns, with what is assumed held (p, p).

    What all of them owe to the same gravity goes in proportion, and needs no profile.
    """
    held = [fit.names.index(name) for name in fit.assumed]
    whole = fit.internal_covariance
    if held:
        whole = whole - whole[:, held] @ np.linalg.solve(whole[np.ix_(held, held)], whole[held])
    variance = np.diag(whole)
    u = np.sqrt(np.where(variance > 1e-20 * np.diag(fit.internal_covariance), variance, np.inf))
    return np.asarray(np.abs(whole / np.outer(u, u)) * (1 - np.eye(len(u))))


def profile(fit: Fit, name: str, level: float = LEVEL) -> Profile:
    """The profile of one unknown.

    Args:
        fit: the fit.
        name: the unknown.
        level: Δχ² of the interval's ends.
    """
    problem, k = fit.problem, fit.names.index(name)
    least = float(np.sum(problem.residuals(fit.x) ** 2))
    u = _step_of(fit, k)
    places = np.array([-p for p in reversed(_PLACES)] + list(_PLACES)) * u + fit.x[k]
    at, rise = _least_chi2(fit, problem, k, places, least)
    for side in (-1, 1):
        ends = rise[0] if side < 0 else rise[-1]
        reached = at[0] <= problem.low[k] if side < 0 else at[-1] >= problem.high[k]
        if ends < level and not reached:
            more = np.sort(fit.x[k] + side * np.array(_FAR) * u)
            far, far_rise = _least_chi2(fit, problem, k, more, least)
            at = np.concatenate((far, at) if side < 0 else (at, far))
            rise = np.concatenate((far_rise, rise) if side < 0 else (rise, far_rise))
    low, open_low = _crossing(at, rise, fit.x[k], level, -1, float(problem.low[k]))
    high, open_high = _crossing(at, rise, fit.x[k], level, 1, float(problem.high[k]))
    ends = (float(external(name, low)), open_low), (float(external(name, high)), open_high)
    (low, open_low), (high, open_high) = sorted(ends)
    return Profile(name, external(name, at), rise, low, high, open_low, open_high)


def _step_of(fit: Fit, k: int) -> float:
    """Standard uncertainty of the internal number; for one held by a bound, from its own column."""
    u = float(np.sqrt(fit.internal_covariance[k, k]))
    if u > 0:
        return u
    problem = fit.problem
    jacobian = least_squares.jacobian_of(problem.residuals, fit.x[None, :], problem.size)[0]
    return float(np.sqrt(least_squares.covariance_of(jacobian / problem.size)[k, k]))


def _least_chi2(
    fit: Fit, problem: Problem, k: int, places: Array, least: float
) -> tuple[Array, Array]:
    """The places within bounds, and how much χ² is above its least there."""
    places = np.unique(np.clip(places, problem.low[k], problem.high[k]))
    others = [j for j in range(len(fit.x)) if j != k]
    if not others:
        chi2 = np.sum(problem.residuals(places[:, None]) ** 2, axis=-1)
        return places, np.maximum(chi2 - least, 0.0)
    variance = fit.internal_covariance[k, k]
    lean = fit.internal_covariance[others, k] / variance if variance > 0 else np.zeros(len(others))
    start = fit.x[others] + np.outer(places - fit.x[k], lean)

    def residuals(x: Array) -> Array:
        whole = np.empty((*x.shape[:-1], len(fit.x)))
        whole[..., others] = x
        whole[..., k] = places
        return problem.residuals(whole)

    found = least_squares.solve(
        residuals, start, problem.low[others], problem.high[others], problem.size[others]
    )
    return places, np.maximum(found.chi2 - least, 0.0)


def _crossing(
    at: Array, rise: Array, centre: float, level: float, side: int, bound: float
) -> tuple[float, bool]:
    """Where the profile reaches the level on one side, by the root of χ², which is near a line."""
    beyond = (at - centre) * side > 0
    place, root = (at[beyond] - centre) * side, np.sqrt(rise[beyond])
    order = np.argsort(place)
    place = np.concatenate(([0.0], place[order]))
    root = np.concatenate(([0.0], root[order]))
    over = np.flatnonzero(root >= np.sqrt(level))
    if not len(over):
        return (bound, True)
    i = int(over[0])
    part = (np.sqrt(level) - root[i - 1]) / (root[i] - root[i - 1])
    return centre + side * float(place[i - 1] + part * (place[i] - place[i - 1])), False


def _asymmetric(fit: Fit, problem: Problem, k: int) -> bool:
    """Whether Δχ² two uncertainties to either side, the others following, is not 4."""
    lean = fit.internal_covariance[k] / np.sqrt(fit.internal_covariance[k, k])
    both = np.clip(fit.x + np.array([[-2.0], [2.0]]) * lean, problem.low, problem.high)
    least = float(np.sum(problem.residuals(fit.x) ** 2))
    rise = np.sum(problem.residuals(both) ** 2, axis=-1) - least
    return bool(np.any(np.abs(rise - 4) > 4 * _ASYMMETRIC))
