"""Each engine's own restitution with our helps, from three drops at different phases of its step.

All else that an engine is given is the closed form's, so that nothing takes up what it errs in.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from simcompare.fitting.bounces import one_number
from simcompare.fitting.bounces.deviations import (
    Deviation,
    RunDeviation,
    deviation_of,
    ends_s,
    engine_bounces,
    mean_deviation,
    scenes,
    uneven,
)
from simcompare.fitting.bounces.engine_fit import EngineFit, contact_rows
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.one_number import RESTITUTION, OneNumber
from simcompare.fitting.bounces.problem import Problem, observed_in
from simcompare.fitting.bounces.roles import Roles
from simcompare.inference.defect_correction import Corrected, correct
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, Settings
from simcompare.model.trajectory import Array, Trajectory
from simcompare.running.jobs import OK, Job, Outcome
from simcompare.running.runner import TIME_LIMIT_S, Progress

#: drops at different phases of the step in each round
DITHERS = 3
#: simulated time after the last measured impact [s]
_AFTER_S = 0.05


@dataclass(frozen=True)
class AssistedFit(EngineFit):
    """What one engine must be given together with our helps.

    Attributes:
        residuals_s: measured less simulated impact times, drop by drop.
    """

    residuals_s: tuple[tuple[float, ...], ...] = ()


def fit_engines(
    roles: Roles,
    plain: OneNumber,
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
        plain: the closed form with one restitution.
        engines: names.
        helps: our helps that are taken; ``None``: all.
        step_s: time between samples; the scenario's own where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.
    """
    start = plain.fit
    problem, settings = start.problem, Settings(ASSISTED, helps=helps)
    states = {name: Corrected(start.x) for name in engines}
    latest: dict[str, _Shown] = {}

    def jobs_of(name: str, x: Array) -> list[Job]:
        return [
            Job(name, scene, settings, drop) for drop, scene in _scenes(roles, problem, x, step_s)
        ]

    def corrected(name: str, one: Corrected) -> Array:
        found = _shown(roles, problem, one.x, one.last)
        if RESTITUTION not in problem.names:
            latest[name] = found
            return one.x
        solved = _without_defects(problem, one.x, found)
        latest[name] = replace(found, spread=solved[1:])
        return np.where([n == RESTITUTION for n in problem.names], solved[0], one.x)

    correct(states, jobs_of, corrected, time_limit_s=time_limit_s, progress=progress)
    return [
        _failed(name, one) if one.failure is not None
        else _result(name, plain, one, latest[name])
        for name, one in states.items()
    ]  # fmt: skip


@dataclass(frozen=True)
class _Shown:
    """What one engine showed in its last round.

    Attributes:
        bouncing: of every drop, mean over the dithers.
        parts: of every drop, dither by dither.
        runs: the middle simulation of every drop.
        spread: the restitution that each dither alone would give (DITHERS,).
    """

    bouncing: tuple[Deviation, ...]
    parts: tuple[tuple[RunDeviation, ...], ...]
    runs: tuple[tuple[Scenario, Trajectory], ...]
    spread: Array = field(default_factory=lambda: np.zeros(0))


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


def _shown(roles: Roles, problem: Problem, x: Array, outcomes: Sequence[Outcome]) -> _Shown:
    """What every drop showed, dither by dither as well, and its middle run."""
    bouncing, every, middle = [], [], []
    for drop, impacts in enumerate(problem.drops):
        runs = [
            (o.job.scenario, o.trajectory)
            for o in outcomes if o.job.repeat == drop and o.trajectory is not None
        ]  # fmt: skip
        values = problem.values(x, drop)
        parts = tuple(deviation_of(roles, values, scene, run, impacts.count) for scene, run in runs)
        middle.append(runs[DITHERS // 2])
        bouncing.append(mean_deviation(parts, impacts.count, whole=True))
        every.append(parts)
    return _Shown(tuple(bouncing), tuple(every), tuple(middle))


def _without_defects(problem: Problem, x: Array, external: _Shown) -> Array:
    """The restitution for data less the mean defect, and less that of each dither alone."""
    dithers = [
        [mean_deviation([parts[i]], impacts.count, whole=True)
         for parts, impacts in zip(external.parts, problem.drops, strict=True)]
        for i in range(DITHERS)
    ]  # fmt: skip
    data = np.stack(
        [problem.data - _in_data(problem, x, one) for one in (external.bouncing, *dithers)]
    )
    return one_number.restitutions(problem, x, data)


def _in_data(problem: Problem, x: Array, external: Sequence[Deviation]) -> Array:
    """The defect as it shows in the measured numbers."""
    parts = []
    for drop, (impacts, deviation) in enumerate(zip(problem.drops, external, strict=True)):
        values = problem.values(x, drop)
        closed = problem.bounces(x, drop, impacts.count)
        engine = engine_bounces(closed, deviation)
        for block in problem.blocks:
            if block.drop == drop:
                ours = observed_in(block, impacts, engine, values, ())
                parts.append(ours - observed_in(block, impacts, closed, values, ()))
    return np.concatenate(parts)


def _failed(name: str, one: Corrected) -> AssistedFit:
    bad = one.failure
    assert bad is not None
    return AssistedFit(name, bad.facts.version, ASSISTED, bad.status, bad.reason,
                       simulations=one.simulations, wall_s=one.wall_s, outcome=bad)  # fmt: skip


def _result(name: str, plain: OneNumber, one: Corrected, engine: _Shown) -> AssistedFit:
    last, start, problem = one.last[0], plain.fit, plain.fit.problem
    assert last.trajectory is not None
    fitted, u_num = start, dict.fromkeys(start.names, 0.0)
    if RESTITUTION in start.names:
        phase = float(np.std(engine.spread, ddof=1)) / math.sqrt(DITHERS)
        u_num[RESTITUTION] = math.hypot(phase, uneven(engine.bouncing))
        value = float(one.x[start.names.index(RESTITUTION)])
        fitted = one_number.with_engine(start, value, u_num[RESTITUTION])
    effective = _effective(engine)
    return AssistedFit(
        name, last.facts.version, ASSISTED, OK, None, fitted, plain.misfit, u_num, effective,
        _whole_u(start, effective[1]), engine.bouncing, contact_rows(last.trajectory),
        one.simulations, one.wall_s, last, engine.runs,
        tuple(_residuals_s(problem, one.x, engine, drop) for drop in range(len(problem.drops))),
    )  # fmt: skip


def _effective(engine: _Shown) -> tuple[float, float]:
    """Mean restitution that the engine showed over the measured bounces, and its own part of u.

    Taken in the last round, at parameters that the last fit moved by no more than its own scatter.
    """
    every = np.concatenate([deviation.restitution for deviation in engine.bouncing])
    each = np.concatenate([deviation.u_restitution for deviation in engine.bouncing])
    phase = float(np.sqrt(np.mean(each**2) / (DITHERS * len(every))))
    return float(every.mean()), math.hypot(phase, uneven(engine.bouncing))


def _whole_u(start: Fit, u_engine: float) -> float:
    """Standard uncertainty of the effective restitution: of the fit, and of the engine."""
    if RESTITUTION not in start.names:
        return u_engine
    return math.hypot(u_engine, float(start.u[start.names.index(RESTITUTION)]))


def _residuals_s(problem: Problem, x: Array, engine: _Shown, drop: int) -> tuple[float, ...]:
    """Measured less simulated impact times of one drop, at the fitted parameters."""
    impacts = problem.drops[drop]
    if not len(impacts.times_s):
        return ()
    closed = problem.bounces(x, drop, impacts.count)
    simulated = closed.impact_s + engine.bouncing[drop].late_s
    return tuple((impacts.times_s - simulated[np.array(impacts.numbers) - 1]).tolist())
