"""Maximum likelihood of a closed form on the events of a bouncing ball, with its uncertainty.

The residuals are those of events (impact times with their full covariance, or the times between
them, rebound heights) or, for a video, of samples that stay within the flight they belong to;
both are smooth in every unknown. Raw trajectories, whose residuals jump at impacts that move, are
never fitted. Scatter beyond what is stated widens the data, not the priors: s² = max(1, χ²/ν),
from the data alone where they suffice. Where only the scatter tells the uncertainty, from ν degrees
of freedom, estimates follow Student's t; all uncertainties are then those of the normal law whose
95 % interval is as wide (JCGM 100, G.3 and G.6; for ν ≥ 3 within 7 % of the standard deviation of
the t law, JCGM 101, 6.4.9).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from simcompare.fitting.bounces import bounce_models, initial_guess
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.problem import Problem, build
from simcompare.fitting.bounces.unknowns import SPEED, base, external, slope
from simcompare.model.trajectory import Array
from simcompare.statistics import least_squares

#: Δχ² of a 95 % interval of one unknown, and its root
LEVEL = 3.841458820694124
COVERAGE = math.sqrt(LEVEL)
#: s² above which the scatter is mentioned, and the largest chance that a scatter may have then
_SCATTERED, BY_CHANCE = 2.0, 0.01
#: unknowns that no reader asks for; they get no profile
NUISANCE = ("release_time_s", "floor_m")
#: part of a prior's uncertainty that is left where the data say nothing
_ITS_PRIOR_ALONE = 0.9


@dataclass(frozen=True)
class Profile:
    """Least χ² at given values of one unknown.

    Attributes:
        name: the unknown.
        values: where it was held (m,), in the order of the internal number.
        chi2: least χ² there, less that of the fit (m,).
        low: lower end of the 95 % interval; minus infinity (infinite speed: infinity) if open.
        high: upper end.
        open_low: χ² stays below 3.84 as far as was looked on the lower side of the interval.
        open_high: the same on the upper side.
    """

    name: str
    values: Array
    chi2: Array
    low: float
    high: float
    open_low: bool
    open_high: bool


@dataclass(frozen=True)
class Fit:
    """Fitted parameters and how sure they are.

    Attributes:
        model: name of the model.
        names: the unknowns.
        values: estimates (p,).
        covariance: of the estimates (p, p); NaN for a terminal speed that may be infinite.
        intervals: 95 % interval of each unknown; an end that the data leave open is infinite.
        how: of each interval: "normal" or "profile".
        chi2: of the data at the estimate, with the stated uncertainties.
        strain: χ² of the priors at the estimate.
        dof: degrees of freedom of ``s2``.
        s2: max(1, χ²/ν), or χ²/ν where no uncertainty is stated.
        count: number of measured numbers.
        effective: how many unknowns the data, not the priors, determine.
        rms: of the residuals, by kind: "times" and "intervals" [s], "heights" and "track" [m].
        speeds_m_s: slowest and fastest impact whose rebound was recorded [m/s].
        pulls: how far each prior is from what the data say, in standard uncertainties.
        at_bound: unknowns that ended at a bound.
        profiles: of the unknowns whose normal interval may be wrong.
        problem: what was fitted.
        x: the internal numbers (1/v_t² for the terminal speed).
        internal_covariance: of these.
    """

    model: str
    names: tuple[str, ...]
    values: Array
    covariance: Array
    intervals: tuple[tuple[float, float], ...]
    how: tuple[str, ...]
    chi2: float
    strain: float
    dof: int
    s2: float
    count: int
    effective: float
    rms: Mapping[str, float]
    speeds_m_s: tuple[float, float]
    pulls: Mapping[str, float]
    at_bound: tuple[str, ...]
    profiles: Mapping[str, Profile]
    problem: Problem = field(repr=False, compare=False)
    x: Array = field(repr=False, compare=False)
    internal_covariance: Array = field(repr=False, compare=False)

    @property
    def u(self) -> Array:
        """Standard uncertainties (p,); NaN where none can be stated."""
        return np.asarray(np.sqrt(np.diag(self.covariance)), dtype=float)

    @property
    def is_scattered(self) -> bool:
        """Whether the data scatter by more than is stated and than chance explains."""
        return self.s2 > _SCATTERED and not explained(self.s2, self.dof)

    @property
    def assumed(self) -> tuple[str, ...]:
        """What is known by its prior alone: of the place and the recorder, or what nobody stated.

        It is no finding, so nothing is said of what the data tell of it.
        """
        index, _, u = self.problem.firm.prior_rows
        left = np.sqrt(np.diag(self.internal_covariance))[index]
        return tuple(self.names[k] for k in index[left > _ITS_PRIOR_ALONE * u])

    @property
    def found(self) -> tuple[str, ...]:
        """The unknowns of which the data say something."""
        return tuple(name for name in self.names if name not in self.assumed)

    @property
    def correlation(self) -> Array:
        """Correlation of the internal numbers, whose signs are those of the parameters (p, p)."""
        u = np.sqrt(np.diag(self.internal_covariance))
        sign = np.array([-1.0 if base(name) == SPEED else 1.0 for name in self.names])
        whole = np.where(u > 0, u, 1.0)
        return np.asarray(self.internal_covariance / np.outer(whole, whole) * np.outer(sign, sign))

    def as_dict(self) -> dict[str, float]:
        """Unknown -> estimate."""
        return dict(zip(self.names, self.values.tolist(), strict=True))

    def restitution_at(self, speed_m_s: float) -> tuple[float, float]:
        """Effective restitution at that speed and its standard uncertainty."""
        value, slopes = self.restitution_with_slopes(speed_m_s)
        return value, math.sqrt(max(float(slopes @ self.internal_covariance @ slopes), 0.0))

    def restitution_with_slopes(self, speed_m_s: float) -> tuple[float, Array]:
        """The same and its derivatives to the internal numbers (p,)."""
        speed = np.array([speed_m_s])
        model = bounce_models.model_of(self.model)

        def law(x: Array) -> Array:
            values = {n: np.asarray(v)[..., None] for n, v in self.problem.values(x, 0).items()}
            return bounce_models.restitution_at(model, values, speed)

        moves = np.eye(len(self.x)) * 1e-6 * self.problem.size
        slopes = [(law(self.x + m) - law(self.x - m)) / (2 * m.sum()) for m in moves]
        return float(law(self.x)[0]), np.concatenate(slopes)


def explained(s2: float, dof: int) -> bool:
    """Whether chance explains a scatter beyond what is stated."""
    from scipy import special

    return float(special.chdtrc(dof, s2 * dof)) >= BY_CHANCE


def spread(problem: Problem, s2: float, dof: int) -> float:
    """What the uncertainties of the data are multiplied by.

    By the root of s², and where the scatter alone tells them by that of Student's t beside the
    normal law.
    """
    from scipy import special

    if dof == 0 or (problem.u_known and explained(s2, dof)):
        return math.sqrt(s2)
    return math.sqrt(s2) * float(special.stdtrit(dof, 0.975)) / COVERAGE


def summary(
    whole: Problem, scaled: Problem, best: least_squares.Solution, s2: float, dof: int
) -> Fit:
    """The fit with normal intervals and no warnings yet."""
    x, held = best.x[0], best.at_bound[0] != 0
    covariance = least_squares.covariance_of(best.jacobian[0], held)
    rows = len(whole.data)
    own = best.jacobian[0][:rows]
    values = np.array([float(external(n, v)) for n, v in zip(whole.names, x, strict=True)])
    scale = np.array([scale_of(n, v) for n, v in zip(whole.names, values, strict=True)])
    half = COVERAGE * np.sqrt(np.diag(covariance))
    intervals = tuple(
        as_interval(name, low, high)
        for name, low, high in zip(whole.names, x - half, x + half, strict=True)
    )
    residual = whole.residuals(x)
    strain = float(np.sum(residual[rows:] ** 2))
    residual = residual[:rows]
    told = np.any(own, axis=0)  # what nothing depends on has a covariance without bound
    own, spread = own[:, told], covariance[np.ix_(told, told)]
    effective = float(np.clip(np.trace(own @ spread @ own.T), 0.0, len(values)))
    return Fit(
        model=whole.model.name, names=whole.names, values=values,
        covariance=covariance * np.outer(scale, scale), intervals=intervals,
        how=("normal",) * len(values), chi2=float(residual @ residual), strain=strain, dof=dof,
        s2=s2, count=rows, effective=effective, rms=_rms(whole, x),
        speeds_m_s=_speeds(whole, x), pulls={},
        at_bound=tuple(n for n, h in zip(whole.names, held, strict=True) if h), profiles={},
        problem=scaled, x=x, internal_covariance=covariance,
    )  # fmt: skip


def as_interval(name: str, low: float, high: float) -> tuple[float, float]:
    """Ends of an interval of the internal number as values of the unknown, the lower first."""
    ends = float(external(name, low)), float(external(name, high))
    return min(ends), max(ends)


def shape(impacts: Impacts, model: str, count: int) -> tuple[Array, Array]:
    """Impact times 1 … count of the closed form that fits best, and the residuals' Jacobian."""
    problem = build([impacts], bounce_models.model_of(model))
    best = minimum(problem, initial_guess.of(problem))
    return problem.bounces(best.x[0], 0, count).impact_s, best.jacobian[0]


def minimise(
    problem: Problem,
    start: Array,
    data: Array | None = None,
    mean: Array | None = None,
) -> least_squares.Solution:
    """Fits of the same problem side by side, from starts (B, p) and to data (B, n)."""
    return least_squares.solve(
        lambda x: problem.residuals(x, data, mean),
        start, problem.low, problem.high, problem.size,
    )  # fmt: skip


def minimum(problem: Problem, start: Array) -> least_squares.Solution:
    """One fit from one start (p,)."""
    return minimise(problem, start[None, :])


def scale_of(name: str, value: float) -> float:
    """Derivative of the value to the internal number; NaN where the value is infinite."""
    return 1 / slope(name, value) if math.isfinite(value) else math.nan


def _rms(problem: Problem, x: Array) -> dict[str, float]:
    residual = problem.data - problem.predicted(x)
    found: dict[str, list[Array]] = {}
    at = 0
    for block in problem.blocks:
        found.setdefault(block.kind, []).append(residual[at : at + len(block.data)])
        at += len(block.data)
    return {k: float(np.sqrt(np.mean(np.concatenate(v) ** 2))) for k, v in found.items()}


def _speeds(problem: Problem, x: Array) -> tuple[float, float]:
    speeds = speeds_of(problem, x)
    return min(speeds), max(speeds)


def speeds_of(problem: Problem, x: Array) -> list[float]:
    """Speeds of all impacts whose rebound was recorded [m/s]."""
    return [
        speed
        for number, drop in enumerate(problem.drops)
        for speed in np.ravel(problem.bounces(x, number, drop.rebounds).speed_m_s).tolist()
    ]
