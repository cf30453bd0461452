"""The one restitution that an engine has, where that of the ball depends on the speed.

An engine gets drag, heights and clocks as the closed form has them, and of the contact one number.
Nothing else is fitted again, so that nothing takes up what one number cannot show. How far the
recorded impacts are from it is a part of its uncertainty, as for a correction that is known and not
applied (GUM, JCGM 100:2008, F.2.4.5).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from simcompare.fitting.bounces.bounce_models import MODELS
from simcompare.fitting.bounces.likelihood import COVERAGE, Fit, speeds_of
from simcompare.fitting.bounces.problem import Problem
from simcompare.fitting.bounces.unknowns import SPEED
from simcompare.model.trajectory import Array
from simcompare.statistics import least_squares

RESTITUTION, EXPONENT = "restitution", "exponent"
#: speed [m/s] -> restitution and its standard uncertainty
Law = Callable[[float], tuple[float, float]]


@dataclass(frozen=True)
class OneNumber:
    """The closed form with one restitution for all speeds.

    Attributes:
        fit: its parameters; all but the restitution are those of the closed form.
        misfit: root mean square by which the restitution of the recorded impacts differs from it; 0
            where that does not depend on the speed.
        most: the largest of these differences.
    """

    fit: Fit
    misfit: float
    most: float = 0.0


def at_speed(best: Fit, law: Law, speed_m_s: float, *, with_drag: bool = True) -> OneNumber:
    """The restitution of one speed for all of them.

    Args:
        best: the closed form.
        law: its restitution.
        speed_m_s: the speed.
        with_drag: whether the scene can have drag.
    """
    return _of(best, law, *law(speed_m_s), with_drag)


def nearest(best: Fit, law: Law, *, with_drag: bool = True) -> OneNumber:
    """The one restitution that follows what was measured best, all else as the closed form has it.

    Args:
        best: the closed form.
        law: its restitution.
        with_drag: whether the scene can have drag.
    """
    u = math.sqrt(float(np.mean([law(speed)[1] ** 2 for speed in speeds_of(best.problem, best.x)])))
    problem, x = _constant(best, law(best.speeds_m_s[1])[0], with_drag)
    if best.problem.model.law == "constant" and with_drag:
        value = float(best.problem.values(best.x, 0)[RESTITUTION])
    else:
        value = float(restitutions(problem, x, problem.data[None, :])[0])
    return _of(best, law, value, u, with_drag)


def restitutions(problem: Problem, x: Array, data: Array) -> Array:
    """The restitution that follows each of several data (B, n) best, all else held (B,)."""
    k = problem.names.index(RESTITUTION)

    def residuals(e: Array) -> Array:
        whole = np.broadcast_to(x, (*e.shape[:-1], len(x))).copy()
        whole[..., k] = e[..., 0]
        return problem.residuals(whole, data)

    start = np.full((len(data), 1), x[k])
    bounds = problem.low[[k]], problem.high[[k]], problem.size[[k]]
    return np.asarray(least_squares.solve(residuals, start, *bounds).x[:, 0])


def with_engine(fit: Fit, value: float, u_engine: float) -> Fit:
    """The same with the restitution that an engine needs, and its own part of the uncertainty."""
    k = fit.names.index(RESTITUTION)
    own = np.zeros_like(fit.covariance)
    own[k, k] = u_engine**2
    ends = _moved(fit.intervals[k], float(fit.values[k]), value, u_engine)
    return _put(fit, value, ends, fit.covariance + own, fit.internal_covariance + own)


def _of(best: Fit, law: Law, value: float, u: float, with_drag: bool) -> OneNumber:
    gaps = [law(speed)[0] - value for speed in speeds_of(best.problem, best.x)]
    misfit, most = math.sqrt(float(np.mean(np.square(gaps)))), float(np.max(np.abs(gaps)))
    whole = math.hypot(u, misfit)
    if best.problem.model.law == "constant" and with_drag:
        if RESTITUTION not in best.names:
            return OneNumber(best, 0.0)
        return OneNumber(_told(best, value, whole), misfit, most)
    problem, x = _constant(best, value, with_drag)
    kept = [best.names.index(n) for n in problem.names if n in best.names]
    fit = replace(best, model="constant" + "+drag" * problem.model.drag, problem=problem, x=x)
    fit = _rows(fit, best, problem.names, kept)
    return OneNumber(_told(fit, value, whole), misfit, most)


def _told(fit: Fit, value: float, u: float) -> Fit:
    """The fit with that restitution and its standard uncertainty."""
    k = fit.names.index(RESTITUTION)
    if math.isclose(value, float(fit.values[k]), rel_tol=1e-12) and math.isclose(
        u, float(fit.u[k]), rel_tol=1e-6
    ):
        return fit
    covariance, internal = fit.covariance.copy(), fit.internal_covariance.copy()
    for matrix in (covariance, internal):
        old = math.sqrt(matrix[k, k]) if matrix[k, k] > 0 else math.inf
        # what correlates with the others is the law's own; the misfit is no error of theirs
        own = min(u, old)
        matrix[k, :] *= own / old
        matrix[:, k] *= own / old
        matrix[k, k] = u**2
    ends = value - COVERAGE * u, value + COVERAGE * u
    return _put(fit, value, ends, covariance, internal)


def _put(
    fit: Fit, value: float, ends: tuple[float, float], covariance: Array, internal: Array
) -> Fit:
    """The fit with that restitution, its interval, and these covariances."""
    k = fit.names.index(RESTITUTION)
    values, x, intervals = fit.values.copy(), fit.x.copy(), list(fit.intervals)
    values[k] = x[k] = value
    intervals[k] = ends
    return replace(fit, values=values, x=x, covariance=covariance, internal_covariance=internal,
                   intervals=tuple(intervals))  # fmt: skip


def _rows(fit: Fit, best: Fit, names: tuple[str, ...], kept: list[int]) -> Fit:
    """The rows of the closed form's fit that belong to these names."""
    place = [k for k, name in enumerate(names) if name in best.names]

    def square(matrix: Array) -> Array:
        found = np.zeros((len(names), len(names)))
        found[np.ix_(place, place)] = matrix[np.ix_(kept, kept)]
        return found

    values = np.zeros(len(names))
    values[place] = best.values[kept]
    ends, how = [(0.0, 0.0)] * len(names), ["normal"] * len(names)
    for ours, theirs in zip(place, kept, strict=True):
        ends[ours], how[ours] = best.intervals[theirs], best.how[theirs]
    return replace(
        fit, names=names, values=values, covariance=square(best.covariance),
        internal_covariance=square(best.internal_covariance), intervals=tuple(ends),
        how=tuple(how), profiles={n: p for n, p in best.profiles.items() if n in names},
    )  # fmt: skip


def _constant(best: Fit, value: float, with_drag: bool) -> tuple[Problem, Array]:
    """The same problem with a constant restitution, and the closed form's numbers in it."""
    problem = best.problem
    without = {EXPONENT, *(() if with_drag else (SPEED,))}
    names = tuple(n for n in problem.names if n not in without)
    names = names if RESTITUTION in names else (RESTITUTION, *names)
    held = {n: v for n, v in problem.fixed.items() if n not in (RESTITUTION, *without)}
    law = problem.model.law == "constant"
    priors = {n: p for n, p in problem.priors.items() if n in names and (law or n != RESTITUTION)}
    drag = SPEED in names
    model = MODELS["constant+drag" if drag else "constant"]
    known = dict(zip(problem.names, best.x.tolist(), strict=True))
    x = np.array([value if n == RESTITUTION else known[n] for n in names])
    return replace(problem, model=model, names=names, fixed=held, priors=priors), x


def _moved(
    ends: tuple[float, float], at: float, value: float, u_more: float
) -> tuple[float, float]:
    """An interval about another value, wider by a further uncertainty."""
    extra = COVERAGE * u_more
    return value - math.hypot(at - ends[0], extra), value + math.hypot(ends[1] - at, extra)
