"""Each engine's own parameters with our helps, by correcting its defect.

An engine given the parameters x shows events that are a little off those of the closed form at x:
its step, its contact, its drag. That defect hardly changes with x. So the closed form is fitted to
the measured events less the defect, the engine is run with what comes out, and this is repeated:
space mapping (J. W. Bandler et al., IEEE Trans. Microwave Theory Tech. 42 (1994) 2536). Two rounds
of three drops that fall at different phases of the step are enough, and no difference quotient of
an engine is ever taken, which would only show its scatter.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from simcompare.errors import SimcompareError
from simcompare.fitting.bounces import bounce_models, likelihood
from simcompare.fitting.bounces.beside import (
    Bouncing,
    Part,
    beside,
    ends_s,
    engine_bounces,
    scenes,
    together,
)
from simcompare.fitting.bounces.engine_fit import EngineFit, contact_rows
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.problem import Problem, seen_in
from simcompare.fitting.bounces.roles import Roles
from simcompare.fitting.bounces.unknowns import shown
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, Settings
from simcompare.model.trajectory import Array, Trajectory
from simcompare.running.jobs import FAILED, OK, Job, Outcome
from simcompare.running.runner import TIME_LIMIT_S, Progress, run_jobs

#: drops at different phases of the step in each round, and rounds
DITHERS, ROUNDS = 3, 2
#: simulated time after the last measured impact [s]
_AFTER_S = 0.05


@dataclass(frozen=True)
class AssistedFit(EngineFit):
    """What one engine must be given together with our helps.

    Attributes:
        left_s: measured less simulated impact times, drop by drop.
    """

    left_s: tuple[tuple[float, ...], ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        plain = super().to_dict()
        return {**plain, "left_s": [list(row) for row in self.left_s]} if self.fit else plain


def fit_engines(
    roles: Roles,
    start: Fit,
    engines: Sequence[str],
    *,
    helps: frozenset[str] | None = None,
    step_s: float | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> list[AssistedFit]:
    """Fits all engines, each in a process of its own.

    Args:
        roles: the scenario.
        start: the closed-form fit, with a model that the scenario has: constant restitution, with
            or without drag.
        engines: names.
        helps: our helps that are taken; ``None``: all.
        step_s: time between samples; the scenario's own where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.
    """
    problem = start.problem
    state = {name: _State(start.x) for name in engines}
    settings = Settings(ASSISTED, helps=helps)
    for _ in range(ROUNDS):
        jobs: list[Job] = []
        plan: list[tuple[int, Scenario]] = []
        for name in engines:
            if state[name].outcome_bad is None:
                for drop, scene in _scenes(roles, problem, state[name].x, step_s):
                    jobs.append(Job(name, scene, settings, len(plan)))
                    plan.append((drop, scene))
        outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
        for name in engines:
            own = [(*plan[o.job.repeat], o) for o in outcomes if o.job.engine == name]
            if own:
                _advance(roles, problem, state[name], own)
    return [_result(name, problem, start, state[name]) for name in engines]


@dataclass
class _State:
    """How far the fit of one engine has come."""

    x: Array
    shown: tuple[Bouncing, ...] = ()
    spread: tuple[Array, ...] = ()
    outcome_bad: Outcome | None = None
    last: Outcome | None = None
    simulations: int = 0
    wall_s: float = 0.0
    runs: tuple[tuple[Scenario, Trajectory], ...] = ()


def _scenes(
    roles: Roles, problem: Problem, x: Array, step_s: float | None
) -> list[tuple[int, Scenario]]:
    """Every drop at the phases of one round."""
    found = []
    for drop, impacts in enumerate(problem.drops):
        values = problem.values(x, drop)
        lasts_s = ends_s(values, impacts.count + 1) + _AFTER_S
        nominal = roles.file.resolve(roles.values(values), step_s=step_s)
        whole = min(nominal.world.duration_s, lasts_s)
        found += [(drop, scene) for scene in scenes(roles, values, step_s, whole, DITHERS)]
    return found


def _advance(
    roles: Roles,
    problem: Problem,
    state: _State,
    own: Sequence[tuple[int, Scenario, Outcome]],
) -> None:
    """One round: the defect of the engine at x, and the fit to the events less that."""
    state.simulations += len(own)
    state.last = own[0][2]
    bad = [outcome for *_, outcome in own if outcome.status != OK]
    if bad:
        state.outcome_bad = bad[0]
        return
    walls = [o.trajectory.wall_s for *_, o in own if o.trajectory is not None]
    state.wall_s += sum(wall.get("build", 0.0) + wall.get("step", 0.0) for wall in walls)
    try:
        seen, defects, middle = _seen(roles, problem, state.x, own)
    except SimcompareError as error:
        state.outcome_bad = replace(state.last, status=FAILED, reason=str(error))
        return
    state.shown, state.runs = tuple(seen), tuple(middle)
    # what each dither alone would give: the scatter of the engine in the parameters
    alone = [
        [together([parts[i]], impacts.count, whole=True)
         for parts, impacts in zip(defects, problem.drops, strict=True)]
        for i in range(DITHERS)
    ]  # fmt: skip
    data = np.stack([problem.data - _in_data(problem, state.x, one) for one in (seen, *alone)])
    starts = np.repeat(state.x[None, :], len(data), axis=0)
    solved = likelihood.minimise(problem, starts, data)
    state.x = solved.x[0]
    state.spread = tuple(solved.x[1:])


def _seen(
    roles: Roles, problem: Problem, x: Array, own: Sequence[tuple[int, Scenario, Outcome]]
) -> tuple[list[Bouncing], list[list[Part]], list[tuple[Scenario, Trajectory]]]:
    """What every drop showed, dither by dither as well, and its middle run."""
    seen, defects, middle = [], [], []
    for drop, impacts in enumerate(problem.drops):
        runs = [(s, o.trajectory) for d, s, o in own if d == drop and o.trajectory is not None]
        values = problem.values(x, drop)
        parts = [beside(roles, values, scene, run, impacts.count) for scene, run in runs]
        middle.append(runs[DITHERS // 2])
        seen.append(together(parts, impacts.count, whole=True))
        defects.append(parts)
    return seen, defects, middle


def _in_data(problem: Problem, x: Array, shown: Sequence[Bouncing]) -> Array:
    """The defect as it shows in the measured numbers."""
    parts = []
    for drop, (impacts, seen) in enumerate(zip(problem.drops, shown, strict=True)):
        values = problem.values(x, drop)
        closed = bounce_models.bounces(problem.model, values, impacts.count)
        engine = engine_bounces(closed, seen)
        for block in problem.blocks:
            if block.drop == drop:
                ours = seen_in(block, impacts, engine, values, ())
                parts.append(ours - seen_in(block, impacts, closed, values, ()))
    return np.concatenate(parts)


def _result(name: str, problem: Problem, start: Fit, state: _State) -> AssistedFit:
    bad = state.outcome_bad
    if bad is not None:
        return AssistedFit(name, bad.facts.version, ASSISTED, bad.status, bad.reason,
                           simulations=state.simulations, wall_s=state.wall_s,
                           outcome=bad)  # fmt: skip
    assert state.last is not None
    assert state.last.trajectory is not None
    values = np.array([float(shown(n, v)) for n, v in zip(problem.names, state.x, strict=True)])
    spread = np.std(np.stack(state.spread), axis=0, ddof=1) / math.sqrt(DITHERS)
    u_num = {
        unknown: float(s * likelihood.scale_of(unknown, value))
        for unknown, s, value in zip(problem.names, spread, values, strict=True)
    }
    covariance = start.covariance + np.diag([u_num[unknown] ** 2 for unknown in problem.names])
    intervals = tuple(
        _moved(ends, float(at), float(value), u_num[unknown])
        for ends, at, value, unknown in zip(
            start.intervals, start.values, values, problem.names, strict=True
        )
    )
    fitted = replace(start, values=values, covariance=covariance, intervals=intervals, x=state.x)
    effective = _effective(state)
    return AssistedFit(
        name, state.last.facts.version, ASSISTED, OK, None, fitted, u_num, effective,
        _whole_u(fitted, effective[1]), state.shown, contact_rows(state.last.trajectory),
        state.simulations, state.wall_s, state.last, state.runs,
        tuple(_left(problem, state, drop) for drop in range(len(problem.drops))),
    )  # fmt: skip


def _moved(ends: tuple[float, float], at: float, value: float, u_num: float) -> tuple[float, float]:
    """The closed form's interval about another value, wider by the engine's own scatter."""
    if not (math.isfinite(at) and math.isfinite(value)):
        return ends
    extra = likelihood.COVERAGE * u_num
    return value - math.hypot(at - ends[0], extra), value + math.hypot(ends[1] - at, extra)


def _effective(state: _State) -> tuple[float, float]:
    """Mean restitution that the engine showed over the measured bounces; u from its phase.

    Taken in the last round, at parameters that the last fit moved by no more than its own scatter.
    """
    every = np.concatenate([seen.restitution for seen in state.shown])
    each = np.concatenate([seen.u_restitution for seen in state.shown])
    return float(every.mean()), float(np.sqrt(np.mean(each**2) / (DITHERS * len(every))))


def _whole_u(fitted: Fit, u_phase: float) -> float:
    """Standard uncertainty of the effective restitution: of the fit, and of the engine's phase."""
    if "restitution" not in fitted.names:
        return u_phase
    return math.hypot(u_phase, float(fitted.u[fitted.names.index("restitution")]))


def _left(problem: Problem, state: _State, drop: int) -> tuple[float, ...]:
    """Measured less simulated impact times of one drop, at the fitted parameters."""
    impacts = problem.drops[drop]
    if not len(impacts.times_s):
        return ()
    closed = bounce_models.bounces(problem.model, problem.values(state.x, drop), impacts.count)
    simulated = closed.impact_s + state.shown[drop].late_s
    return tuple((impacts.times_s - simulated[np.array(impacts.numbers) - 1]).tolist())
