"""A closed form fitted to drops: the estimate, its intervals, and what its reader must know."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from simcompare.fitting.bounces import bounce_models, diagnostics, initial_guess, profile
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.likelihood import Fit, minimum, summary
from simcompare.fitting.bounces.problem import Problem, build
from simcompare.fitting.bounces.unknowns import Prior
from simcompare.model.trajectory import Array
from simcompare.statistics import least_squares


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
        unknowns: what is sought; by default all of the model, and the height and release time of
            each drop.
        fixed: values of what is not sought, such as gravity_m_s2 or terminal_speed_m_s.
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
    alone = minimum(whole, first, priors=False) if whole.priors else None
    s2, dof = _scatter(whole, first, alone)
    scaled = whole.widened(math.sqrt(s2))
    best = minimum(scaled, first)
    found = summary(whole, scaled, best, s2, dof)
    ends = profile.intervals(found, scaled) if profiles else None
    return diagnostics.completed(found, scaled, ends)


def _scatter(
    problem: Problem, start: Array, alone: least_squares.Solution | None
) -> tuple[float, int]:
    """s² and its degrees of freedom, from the data alone where they determine the unknowns."""
    dof = len(problem.data) - len(problem.names)
    if alone is not None and dof > 0:
        chi2 = float(alone.chi2[0])
    else:
        dof += len(problem.priors)
        chi2 = float(minimum(problem, start).chi2[0])
    if dof == 0:
        return 1.0, 0
    ratio = chi2 / dof
    return (max(1.0, ratio) if problem.u_known else max(ratio, 1e-12)), dof
