"""Each engine's own parameters from the same events, by correcting its defect.

An engine given the parameters x shows events that are a little off those of the closed form at x:
its step, its contact, its drag. That defect hardly changes with x. So the closed form is fitted to
the measured events less the defect, the engine is run with what comes out, and this is repeated:
space mapping (J. W. Bandler et al., IEEE Trans. Microwave Theory Tech. 42 (1994) 2536). Two rounds
of three drops that fall at different phases of the step are enough, and no difference quotient of
an engine is ever taken, which would only show its scatter.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from simcompare import measures
from simcompare.audit import AuditRow
from simcompare.backend import ASSISTED, Settings
from simcompare.errors import InputError, SimcompareError
from simcompare.fitting import bounce_models, likelihood
from simcompare.fitting.bounce_models import Bounces
from simcompare.fitting.likelihood import Fit
from simcompare.fitting.problem import Problem, seen_in, shown
from simcompare.jobs import FAILED, OK, Job, Outcome
from simcompare.runner import TIME_LIMIT_S, Progress, run_jobs
from simcompare.scenario import Scenario
from simcompare.trajectory import Array, Trajectory
from simcompare.validation.model import Model

#: drops at different phases of the step in each round, and rounds
DITHERS, ROUNDS = 3, 2
#: simulated time after the last measured impact [s]
_AFTER_S = 0.05
#: unknowns of a fit that are parameters of the scenario
_OF_SCENARIO = ("restitution", "drop_height_m", "gravity_m_s2")


@dataclass(frozen=True)
class Bouncing:
    """What a round of simulations of one drop showed beside the closed form.

    Attributes:
        late_s: impact time less that of the reference, mean over the dithers (K,) [s].
        scatter_s: its standard deviation over the dithers (K,) [s].
        higher_m: height of the apexes less those of the reference (K + 1,) [m].
        restitution: effective restitution of each impact, mean over the dithers (K,).
        u_restitution: its standard deviation over the dithers (K,).
        times_s: impact times of the middle drop (K,) [s].
    """

    late_s: Array
    scatter_s: Array
    higher_m: Array
    restitution: Array
    u_restitution: Array
    times_s: Array


@dataclass(frozen=True)
class EngineFit:
    """What one engine must be given, and what it then shows.

    Attributes:
        engine: its name.
        version: its version.
        status: "ok" or how it failed.
        reason: why it failed.
        fit: parameters to be given to it; ``None`` where it failed.
        u_num: unknown -> standard uncertainty from phase and step.
        effective: mean restitution that it shows in the fitted drops, its standard uncertainty.
        shown: what the last round of each drop showed.
        native: contact values that the engine held.
        simulations: how many were run.
        wall_s: wall time of them.
        left_s: measured less simulated impact times, drop by drop.
        outcome: how the last simulation ended.
        runs: the middle simulation of each drop in the last round.
    """

    engine: str
    version: str | None
    status: str
    reason: str | None
    fit: Fit | None = None
    u_num: Mapping[str, float] = field(default_factory=dict)
    effective: tuple[float, float] | None = None
    shown: tuple[Bouncing, ...] = ()
    native: tuple[AuditRow, ...] = ()
    simulations: int = 0
    wall_s: float = 0.0
    left_s: tuple[tuple[float, ...], ...] = ()
    outcome: Outcome | None = field(default=None, repr=False)
    runs: tuple[tuple[Scenario, Trajectory], ...] = field(default=(), repr=False)


def fit_engines(
    model: Model,
    problem: Problem,
    start: Fit,
    engines: Sequence[str],
    given: Mapping[str, float],
    *,
    step_s: float | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> list[EngineFit]:
    """Fits all engines, each in a process of its own.

    Args:
        model: the scenario with its reference.
        problem: the measurement, with a model that the scenario has: constant restitution, with or
            without drag.
        start: its closed-form fit.
        engines: names.
        given: further parameters of the scenario, such as the ball's mass.
        step_s: time between samples; the scenario's own where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.
    """
    state = {name: _State(start.x, np.zeros(len(problem.data))) for name in engines}
    for _ in range(ROUNDS):
        jobs: list[Job] = []
        plan: list[tuple[str, int, Scenario]] = []
        for name in engines:
            if state[name].outcome_bad is None:
                for drop, scene in _scenes(model, problem, state[name].x, given, step_s):
                    jobs.append(Job(name, scene, Settings(ASSISTED), len(plan)))
                    plan.append((name, drop, scene))
        outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
        for name in engines:
            own = [(plan[o.job.repeat], o) for o in outcomes if o.job.engine == name]
            if own:
                _advance(model, problem, state[name], own)
    return [_result(name, problem, start, state[name]) for name in engines]


@dataclass
class _State:
    """How far the fit of one engine has come."""

    x: Array
    defect: Array
    shown: tuple[Bouncing, ...] = ()
    spread: tuple[Array, ...] = ()
    outcome_bad: Outcome | None = None
    last: Outcome | None = None
    simulations: int = 0
    wall_s: float = 0.0
    runs: tuple[tuple[Scenario, Trajectory], ...] = ()


def _scenes(
    model: Model, problem: Problem, x: Array, given: Mapping[str, float], step_s: float | None
) -> list[tuple[int, Scenario]]:
    """Every drop, dithered in height over what it falls in one step at its first impact."""
    found = []
    for drop, impacts in enumerate(problem.drops):
        values = scenario_values(problem, x, drop, given)
        nominal = model.file.resolve(values, step_s=step_s)
        closed = bounce_models.bounces(problem.model, problem.values(x, drop), impacts.count + 1)
        lasts_s = float(np.ravel(closed.apex_s)[-1] if impacts.track is None else closed.apex_s[-1])
        whole = min(nominal.world.duration_s, lasts_s + _AFTER_S)
        step = nominal.world.step_s
        span = math.sqrt(2 * values.get("gravity_m_s2", 9.80665) * values["drop_height_m"]) * step
        for i in range(DITHERS):
            height = values["drop_height_m"] + (i - DITHERS // 2) / DITHERS * span
            scene = model.file.vary(nominal, "drop_height_m", height)
            world = scene.world.model_copy(update={"duration_s": round(whole / step) * step})
            found.append((drop, scene.model_copy(update={"world": world})))
    return found


def scenario_values(
    problem: Problem, x: Array, drop: int, given: Mapping[str, float]
) -> dict[str, float]:
    """Parameters of the scenario for sought numbers; drag as a coefficient of the ball given."""
    values = problem.values(x, drop)
    found = {**given, **{name: float(values[name]) for name in _OF_SCENARIO}}
    found["restitution"] = min(max(found["restitution"], 0.0), 0.99)
    k = float(bounce_models.drag_of(values))
    if k > 0:  # k = 1/v_t² = ρ·C·A/(2·m·g)
        area = math.pi * given["radius_m"] ** 2
        found["drag_coefficient"] = (
            2 * k * given["mass_kg"] * found["gravity_m_s2"] / (given["air_density_kg_m3"] * area)
        )
    return found


def _advance(
    model: Model,
    problem: Problem,
    state: _State,
    own: Sequence[tuple[tuple[str, int, Scenario], Outcome]],
) -> None:
    """One round: the defect of the engine at x, and the fit to the events less that."""
    state.simulations += len(own)
    state.last = own[0][1]
    bad = [outcome for _, outcome in own if outcome.status != OK]
    if bad:
        state.outcome_bad = bad[0]
        return
    walls = [o.trajectory.wall_s for _, o in own if o.trajectory is not None]
    state.wall_s += sum(wall.get("build", 0.0) + wall.get("step", 0.0) for wall in walls)
    try:
        seen, defects, middle = [], [], []
        for drop in range(len(problem.drops)):
            runs = [(scene, o.trajectory) for (_, d, scene), o in own if d == drop]
            parts = [_beside_truth(model, scene, run) for scene, run in runs if run is not None]
            middle += [(s, run) for s, run in runs[DITHERS // 2 :][:1] if run is not None]
            seen.append(_together(parts, problem.drops[drop].count))
            defects.append(parts)
    except SimcompareError as error:
        state.outcome_bad = replace(state.last, status=FAILED, reason=str(error))
        return
    state.shown, state.runs = tuple(seen), tuple(middle)
    state.defect = _in_data(problem, state.x, seen)
    # what each dither alone would give: the scatter of the engine in the parameters
    alone = [
        _in_data(problem, state.x, [_together([parts[i]], problem.drops[d].count)
                                    for d, parts in enumerate(defects)])
        for i in range(DITHERS)
    ]  # fmt: skip
    data = np.stack([problem.data - one for one in (state.defect, *alone)])
    starts = np.repeat(state.x[None, :], len(data), axis=0)
    solved = likelihood.minimise(problem, starts, data)
    state.x = solved.x[0]
    state.spread = tuple(solved.x[1:])


def _beside_truth(model: Model, scene: Scenario, run: Trajectory) -> tuple[Array, ...]:
    """Lateness, excess of height, restitution and times of one run, by the same measure of both."""
    measure = scene.measures[0]
    ours = measures.take(measure, scene, run).series
    truth = measures.take(measure, scene, model.truth(scene)).series
    found = []
    for name in ("impact_time", "rebound_height"):
        common = min(len(ours[name]), len(truth[name]))
        found.append(ours[name][:common] - truth[name][:common])
    common = min(len(ours["restitution"]), len(truth["restitution"]))
    # the measure errs alike on both, so the truth's own restitution replaces what it shows of it
    shows = ours["restitution"][:common] - truth["restitution"][:common]
    return (*found, shows + scene.parameters["restitution"], ours["impact_time"])


def _together(parts: Sequence[tuple[Array, ...]], count: int) -> Bouncing:
    """Mean over the dithers.

    Raises:
        InputError: the engine shows fewer impacts than were measured.
    """
    fewest = min(len(late) for late, *_ in parts)
    if fewest < count:
        raise InputError(
            "fit", [f"only {fewest} impacts are seen in the simulation, {count} were measured"]
        )
    late = np.stack([part[0][:count] for part in parts])
    higher = np.stack(
        [np.pad(part[1][:count], (0, max(0, count - len(part[1])))) for part in parts]
    )
    least = min(len(part[2]) for part in parts)
    restitution = np.stack([part[2][: min(count, least)] for part in parts])
    ddof = 1 if len(parts) > 1 else 0
    return Bouncing(
        late.mean(axis=0), late.std(axis=0, ddof=ddof),
        np.concatenate(([0.0], higher.mean(axis=0))),
        restitution.mean(axis=0), restitution.std(axis=0, ddof=ddof),
        parts[len(parts) // 2][3][:count],
    )  # fmt: skip


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


def engine_bounces(closed: Bounces, seen: Bouncing) -> Bounces:
    """Bounces of an engine: those of the closed form, moved by what it shows beside it."""
    later = np.append(seen.late_s[1:], seen.late_s[-1])
    between = np.concatenate(([0.0], (seen.late_s + later) / 2))
    return replace(
        closed,
        impact_s=closed.impact_s + seen.late_s,
        apex_s=closed.apex_s + between,
        apex_m=closed.apex_m + seen.higher_m,
    )


def _result(name: str, problem: Problem, start: Fit, state: _State) -> EngineFit:
    bad = state.outcome_bad
    if bad is not None:
        return EngineFit(name, bad.facts.version, bad.status, bad.reason,
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
    return EngineFit(
        name, state.last.facts.version, OK, None, fitted, u_num, _effective(state),
        state.shown, _contact_rows(state.last.trajectory), state.simulations, state.wall_s,
        tuple(_left(problem, state, drop) for drop in range(len(problem.drops))),
        state.last, state.runs,
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


def _left(problem: Problem, state: _State, drop: int) -> tuple[float, ...]:
    """Measured less simulated impact times of one drop, at the fitted parameters."""
    impacts = problem.drops[drop]
    if not len(impacts.times_s):
        return ()
    closed = bounce_models.bounces(problem.model, problem.values(state.x, drop), impacts.count)
    simulated = closed.impact_s + state.shown[drop].late_s
    return tuple((impacts.times_s - simulated[np.array(impacts.numbers) - 1]).tolist())


def _contact_rows(run: Trajectory) -> tuple[AuditRow, ...]:
    words = ("restitution", "solref", "solimp", "contact")
    return tuple(
        row for row in run.audit
        if any(word in f"{row.quantity} {row.engine_parameter}".lower() for word in words)
    )  # fmt: skip


def as_dict(found: EngineFit) -> dict[str, Any]:
    """Plain values for JSON."""
    plain: dict[str, Any] = {
        "name": found.engine, "version": found.version, "contact": ASSISTED, "status": found.status,
        "reason": found.reason, "simulations": found.simulations, "wall_s": found.wall_s,
    }  # fmt: skip
    if found.fit is None or found.effective is None:
        return {**plain, "parameters": {}, "effective": {}}
    told = found.fit.to_dict()["parameters"]
    units_of = {name: _unit(name) for name in told}
    return {
        **plain,
        "parameters": {
            name: {"value": row["value"], "u": row["u"], "interval95": [row["low"], row["high"]],
                   "unit": units_of[name], "u_num": _finite(found.u_num[name])}
            for name, row in told.items()
        },
        "correlation": found.fit.to_dict()["correlation"],
        "effective": {"restitution": {"value": found.effective[0], "u": whole_u(found),
                                      "u_phase": found.effective[1], "unit": "1"}},
        "native": [vars(row) for row in found.native],
        "left_s": [list(row) for row in found.left_s],
        "shown": [
            {"times_s": seen.times_s.tolist(), "restitution": seen.restitution.tolist(),
             "late_s": seen.late_s.tolist(), "scatter_s": seen.scatter_s.tolist()}
            for seen in found.shown
        ],
    }  # fmt: skip


def whole_u(found: EngineFit) -> float:
    """Standard uncertainty of the effective restitution: of the fit, and of the engine's phase."""
    assert found.fit is not None
    assert found.effective is not None
    if "restitution" not in found.fit.names:
        return found.effective[1]
    return math.hypot(found.effective[1], float(found.fit.u[found.fit.names.index("restitution")]))


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _unit(name: str) -> str:
    from simcompare import units

    return units.unit_of(name.partition("[")[0])
