"""Each engine's own numbers for its plain loop, and what it shows with them beside the closed form.

Nothing is fitted to the engine's run: its numbers are calibrated on drops, so that the restitution
of the first recorded impact is the closed form's, and are then held fixed. What its contact adds,
such as the time that it lasts, is told and never made up for by another restitution.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simcompare.engine.calibration.calibration import PHASES as CALIBRATED
from simcompare.engine.calibration.plan import drop_plans
from simcompare.errors import SimcompareError
from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.deviations import (
    NO_CLOCK,
    Deviation,
    RunDeviation,
    deviation_of,
    ends_s,
    mean_deviation,
    scenes,
    uneven,
)
from simcompare.fitting.bounces.engine_fit import TunedFit, contact_rows
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.roles import Roles
from simcompare.fitting.bounces.tuning_goal import CONTACT_STEPS, TuningGoal
from simcompare.inference.defect_correction import wall_s
from simcompare.model.scenario import Scenario
from simcompare.model.settings import TUNED, PairNumbers, Settings
from simcompare.model.trajectory import Array, Trajectory
from simcompare.model.tuning import TuningRow
from simcompare.results.records.fit_engines import Impact, Number
from simcompare.running.jobs import FAILED, OK, Job, Outcome
from simcompare.running.runner import TIME_LIMIT_S, Progress, run_jobs

#: part by which the last number is changed to see what the restitution makes of it, and at how many
#: of the phases
_CHANGE, _CHANGED_PHASES = 0.03, 6


def tune_engines(
    roles: Roles,
    best: Fit,
    goal: TuningGoal,
    engines: Sequence[str],
    *,
    step_s: float | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> list[TunedFit]:
    """Tunes all engines and runs the drops in their plain loops, each in a process of its own.

    Args:
        roles: the scenario.
        best: the closed form.
        goal: the impact to which they are tuned, and the drops that are run.
        engines: names.
        step_s: time between samples; the scenario's own where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.
    """
    drops = [_drop_scenes(roles, goal, drop, step_s) for drop in range(len(goal.drops))]
    middle = drops[goal.lead][goal.phases // 2]
    plans = tuple(
        replace(plan, speed_m_s=goal.speed_m_s) if _is_goal(plan.restitution, middle, roles)
        else plan for plan in drop_plans(middle)
    )  # fmt: skip
    tuning = Settings(TUNED, drops=plans)
    short = _short_scenes(goal, drops[goal.lead])
    jobs = [Job(name, short[goal.phases // 2], tuning) for name in engines]
    first = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    jobs = []
    for outcome in first:
        if outcome.trajectory is not None:
            numbers = _pair_numbers(outcome.trajectory)
            jobs += [
                Job(outcome.job.engine, scene, Settings(TUNED, numbers=numbers), drop)
                for drop, own in enumerate(drops) for scene in own
            ]  # fmt: skip
            if numbers:
                moved = Settings(TUNED, numbers=tuple(map(_moved, numbers)))
                jobs += [
                    Job(outcome.job.engine, scene, moved, len(drops))
                    for scene in short[:: _every(goal)]
                ]
    outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    return [
        _result(roles, best, goal, one, [o for o in outcomes if o.job.engine == one.job.engine])
        for one in first
    ]


def _drop_scenes(roles: Roles, goal: TuningGoal, drop: int, step_s: float | None) -> list[Scenario]:
    """One drop at every phase of the step, long enough for what contacts add."""
    return scenes(roles, goal.drops[drop], step_s, goal.lasts_s[drop], goal.phases)


def _short_scenes(goal: TuningGoal, lead: Sequence[Scenario]) -> list[Scenario]:
    """The leading drop until after its first impact."""
    step_s = lead[0].world.step_s
    lasts_s = ends_s(goal.drops[goal.lead], 1) + CONTACT_STEPS * step_s
    world = {"duration_s": math.ceil(lasts_s / step_s) * step_s}
    return [one.model_copy(update={"world": one.world.model_copy(update=world)}) for one in lead]


def _is_goal(restitution: float, scene: Scenario, roles: Roles) -> bool:
    return math.isclose(restitution, scene.parameters[roles.restitution], rel_tol=1e-12)


def _every(goal: TuningGoal) -> int:
    """From one phase at which the last number is changed to the next."""
    return max(1, goal.phases // _CHANGED_PHASES)


def _pair_numbers(run: Trajectory) -> tuple[PairNumbers, ...]:
    return tuple(PairNumbers(pair, row.numbers) for row in run.tuning for pair in row.pairs)


def _moved(numbers: PairNumbers) -> PairNumbers:
    """The same with the last number, on which the restitution depends, a little smaller."""
    *chosen, last = numbers.values
    return replace(numbers, values=(*chosen, last * (1 - _CHANGE)))


def _result(
    roles: Roles, best: Fit, goal: TuningGoal, first: Outcome, own: Sequence[Outcome]
) -> TunedFit:
    name, version = first.job.engine, first.facts.version
    count = len(own) + 1
    bad = next((outcome for outcome in (first, *own) if outcome.status != OK), None)
    if bad is not None:
        return TunedFit(name, version, TUNED, bad.status, bad.reason, simulations=count,
                        outcome=bad)  # fmt: skip
    assert first.trajectory is not None
    cost_s = wall_s((first, *own))
    try:
        parts = [_parts(roles, goal, own, drop) for drop in range(len(goal.drops))]
        deviations = [
            mean_deviation(part, limit, whole=False)
            for part, limit in zip(parts, goal.counts, strict=True)
        ]
        slope = _slope(roles, goal, own, parts[goal.lead])
    except SimcompareError as error:
        return TunedFit(name, version, TUNED, FAILED, str(error), simulations=count,
                        wall_s=cost_s, outcome=first)  # fmt: skip
    shown = tuple(deviations[: goal.fitted])
    effective = _effective(parts[: goal.fitted], shown)
    tuning, misfit = tuple(_goal_first(roles, first)), goal.plain.misfit
    # the search for a number ends near its aim
    gap = float(deviations[goal.lead].restitution[0]) - goal.restitution
    middle = tuple(
        (o.job.scenario, o.trajectory)
        for drop in range(goal.fitted)
        for o in [one for one in own if one.job.repeat == drop][goal.phases // 2 :][:1]
        if o.trajectory is not None
    )
    return TunedFit(
        name, version, TUNED, OK, None, goal.plain.fit, misfit, {}, effective,
        math.hypot(effective[1], goal.u, misfit), shown, contact_rows(middle[0][1]), count,
        cost_s, first, middle,
        _numbers(tuning, first.trajectory, math.hypot(goal.u, misfit, gap), slope),
        first.job.scenario.world.engine_step_s, (goal.restitution, goal.u),
        tuple(recorded_impacts(best, goal, shown)),
        max(part.penetration_m for every in parts[: goal.fitted] for part in every),
        tuning, tuple(deviations[goal.fitted :]), tuple(_apexes(goal, deviations)), goal.phases,
    )  # fmt: skip


def _parts(roles: Roles, goal: TuningGoal, own: Sequence[Outcome], drop: int) -> list[RunDeviation]:
    return [
        deviation_of(roles, goal.drops[drop], o.job.scenario, o.trajectory, goal.counts[drop])
        for o in own if o.job.repeat == drop and o.trajectory is not None
    ]  # fmt: skip


def _slope(
    roles: Roles, goal: TuningGoal, own: Sequence[Outcome], lead: Sequence[RunDeviation]
) -> float:
    """How the mean restitution of the first impact follows the last number, in parts of it."""
    changed = [
        deviation_of(roles, goal.drops[goal.lead], o.job.scenario, o.trajectory, 1).restitution
        for o in own if o.job.repeat == len(goal.drops) and o.trajectory is not None
    ]  # fmt: skip
    if not changed or not all(len(one) for one in changed):
        return math.nan
    before = float(np.mean([part.restitution[0] for part in lead[:: _every(goal)]]))
    return (before - float(np.mean([one[0] for one in changed]))) / _CHANGE


def _apexes(goal: TuningGoal, deviations: Sequence[Deviation]) -> list[Array]:
    """Heights of the apexes of the held-out drops."""
    found = []
    for drop in range(goal.fitted, len(deviations)):
        closed = bounce_models.bounces(
            bounce_models.MODELS["constant"], goal.drops[drop], goal.counts[drop]
        )
        higher = deviations[drop].higher_m
        found.append(np.ravel(closed.apex_m)[: len(higher)] + higher)
    return found


def _goal_first(roles: Roles, first: Outcome) -> list[TuningRow]:
    """How the numbers were found, those of the fitted restitution before others."""
    assert first.trajectory is not None
    return sorted(
        first.trajectory.tuning,
        key=lambda row: not _is_goal(row.restitution, first.job.scenario, roles),
    )


def _numbers(
    tuning: Sequence[TuningRow], run: Trajectory, u: float, slope: float
) -> tuple[Number, ...]:
    """An engine's numbers under its own names; the last one carries the uncertainty."""
    if not tuning:
        return ()
    values = tuning[0].numbers
    scatter = tuning[0].at[0].scatter if tuning[0].at else 0.0
    found = []
    for place, value in enumerate(values):
        rows = [row for row in run.audit if row.set_value == value]
        own = 0.0
        if place == len(values) - 1:
            # one bounce tells the mean over all phases to its scatter over √n
            own = abs(value / slope) * math.hypot(u, scatter / math.sqrt(CALIBRATED))
        name = rows[0].engine_parameter if rows else f"number {place + 1}"
        found.append(Number(name, value, own, rows[0].unit if rows else "1"))
    return tuple(found)


def _effective(
    parts: Sequence[Sequence[RunDeviation]], shown: Sequence[Deviation]
) -> tuple[float, float]:
    """Mean over phases of the mean over all recorded impacts, and the engine's part of its u."""
    every = np.array([
        np.concatenate([
            part.restitution[: len(deviations.restitution)]
            for part, deviations in zip(phase, shown, strict=True)
        ]).mean()
        for phase in zip(*parts, strict=True)
    ])  # fmt: skip
    phase = float(every.std(ddof=1)) / math.sqrt(len(every))
    return float(every.mean()), math.hypot(phase, uneven(shown))


def recorded_impacts(best: Fit, goal: TuningGoal, shown: Sequence[Deviation]) -> list[Impact]:
    """Each recorded impact: what all closed forms say of it, and what the engine showed.

    Args:
        best: the closed form whose flights are those of the drops.
        goal: what engines were tuned to.
        shown: what the engine showed, drop by drop.
    """
    found = []
    for drop, deviations in enumerate(shown):
        values, count = best.problem.values(best.x, drop), len(deviations.restitution)
        closed = best.problem.bounces(best.x, drop, count)
        # what the engines are run with has one restitution; the measured ball may have another law
        plain = {**values, **NO_CLOCK}
        law_s = np.ravel(bounce_models.bounces(best.problem.model, plain, count).impact_s)
        run_with = {**goal.drops[drop], **NO_CLOCK}
        run_s = np.ravel(
            bounce_models.bounces(bounce_models.MODELS["constant"], run_with, count).impact_s
        )
        for k in range(count):
            speed, value = float(np.ravel(closed.speed_m_s)[k]), float(deviations.restitution[k])
            law = goal.law(speed)[0]
            scatter = float(deviations.u_restitution[k])
            found.append(
                Impact(
                    drop=drop + 1, number=k + 1, speed_m_s=speed,
                    closed_form=law, restitution=value, u_phase=scatter / math.sqrt(goal.phases),
                    scatter=scatter, deviation=value / law - 1,
                    late_s=float(deviations.late_s[k] + run_s[k] - law_s[k]),
                    scatter_s=float(deviations.scatter_s[k]),
                )
            )  # fmt: skip
    return found
