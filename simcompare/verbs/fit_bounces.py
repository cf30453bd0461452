"""The verb ``fit`` for scenarios whose parameters are told by bounces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from simcompare.comparison.repeats import sample_step_s
from simcompare.engine import engines
from simcompare.engine.assist import ALL, NONE
from simcompare.engine.helps import known
from simcompare.errors import InputError
from simcompare.fitting.bounces import assumed, holdout, limits, model_selection, plot_data, records
from simcompare.fitting.bounces.assisted_fit import fit_engines
from simcompare.fitting.bounces.averaging import Averaged, averaged
from simcompare.fitting.bounces.bounce_models import GRAVITY as STANDARD
from simcompare.fitting.bounces.engine_fit import EngineFit
from simcompare.fitting.bounces.impacts import HEIGHT, Impacts
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.one_number import OneNumber, nearest
from simcompare.fitting.bounces.reading import drops_of
from simcompare.fitting.bounces.request import (
    Constraints,
    candidates,
    check_request,
    given_of,
    named,
    numbers_of,
)
from simcompare.fitting.bounces.roles import Roles, roles_of
from simcompare.fitting.bounces.tune_engines import tune_engines
from simcompare.fitting.bounces.tuning_goal import TuningGoal, goal_of
from simcompare.fitting.bounces.unknowns import GRAVITY, base
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, TUNED
from simcompare.model.trajectory import TRUTH, Trajectory
from simcompare.reports.fit import answer
from simcompare.reports.render.decimation import decimated
from simcompare.results import run_record
from simcompare.results.fit_file import FITTED
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_engines import BouncesEngine
from simcompare.results.records.fit_forms import Prior
from simcompare.results.records.fit_holdout import Holdout
from simcompare.results.records.fit_parts import finite
from simcompare.results.run import Stored
from simcompare.running.runner import Progress
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs import levels
from simcompare.verbs.fitted import MEASURED, Found, record_of, score
from simcompare.verbs.request import FitRequest
from simcompare.verbs.result import Result

#: the unknown that a scene has as its drop
DROP_HEIGHT = "drop_height_m"


def fit_bounces(
    file: ScenarioFile, request: FitRequest, time_limit_s: float, progress: Progress | None
) -> Result:
    """Fits a scenario to impacts and heights: a closed form first, then every engine.

    None of our helps is taken where the request names none.
    """
    helps = levels.chosen_helps(NONE if request.assist is None else request.assist, request.engine)
    given = given_of(file, request.set, request.preset)
    step = request.step
    step_s = None if step is None else sample_step_s(file, given, None, step)
    roles = roles_of(file, given)
    stated = {name: Prior(value, u) for name, (value, u) in (request.priors or {}).items()}
    exact, sought = numbers_of(request.fixed or {}), named(request.unknowns)
    if faults := limits.faults(roles, exact, stated, sought):
        raise InputError(file.name, faults)
    fixed, priors = roles.known(exact, stated)
    settings = file.read_settings(request.set or {})
    check_request(request.recordings, request.hold_out, request.u_time_s, roles, settings)
    gravity = fixed.get(GRAVITY, priors[GRAVITY].value if GRAVITY in priors else STANDARD)
    reading = (request.mapping, request.u_time_s, gravity)
    drops = [drop for name in request.recordings for drop in drops_of(name, *reading)]
    held = [drop for name in request.hold_out for drop in drops_of(name, *reading)]
    limits.check_scale(drops, {"--fix": fixed, "--prior": stated})
    priors = {**assumed.of_recorder(drops, sought), **priors}
    priors = {name: prior for name, prior in priors.items() if name not in fixed}
    constraints = Constraints(sought, fixed, priors)
    choice = model_selection.compare(
        drops,
        candidates(request.model, constraints),
        extra=constraints.extra,
        fixed=constraints.fixed,
        priors=constraints.priors,
    )
    laws = averaged(choice)
    limits.check_found(laws, roles)
    how = _How(engines.select(request.engine), helps, step_s, time_limit_s, progress)
    plain, found, predicted, wanted = _engines(roles, laws, held, constraints, how)
    start = plain.fit
    scene = file.resolve(roles.values(start.problem.values(start.x, 0)), step_s=step_s)
    found_fit = records.of_fit(
        roles, choice, laws, plain, found, predicted, (drops, held),
        records.Made(TUNED if how.tuned else ASSISTED, how.assist, wanted, scene),
    )  # fmt: skip
    if request.model == "auto":
        against = model_selection.drag_excess(choice, constraints)
        found_fit = replace(found_fit, choice=replace(found_fit.choice, drag_excess=against))
    height = next((row.value for name, row in found_fit.closed_form.parameters.items()
                   if base(name) == DROP_HEIGHT), None)  # fmt: skip
    if height is not None:  # the height that is told, in the head as well
        values = {**roles.values(start.problem.values(start.x, 0)), roles.height: height}
        scene = file.resolve(values, step_s=step_s)
    recorded = _recorded(drops, choice.best)
    return _gather(file, request, answer.worded(finite(found_fit)), found, scene, recorded)


@dataclass(frozen=True)
class _How:
    """How engines are fitted."""

    engines: Sequence[str]
    helps: frozenset[str] | None
    step_s: float | None
    time_limit_s: float
    progress: Progress | None

    @property
    def tuned(self) -> bool:
        """Whether engines run in their plain loop."""
        return self.helps == frozenset()

    @property
    def assist(self) -> str:
        """The helps as they are typed."""
        return ALL if self.helps is None else known(self.helps) or NONE


def _engines(
    roles: Roles,
    laws: Averaged,
    held: Sequence[Impacts],
    constraints: Constraints,
    how: _How,
) -> tuple[OneNumber, Sequence[EngineFit], Holdout, TuningGoal | None]:
    """What engines get of the closed form, what they make of it, and held-out drops."""
    best = laws.shares[0].fit
    closed = holdout.predict(laws, held, constraints.fixed)
    more: dict[str, Any] = {
        "step_s": how.step_s, "time_limit_s": how.time_limit_s, "progress": how.progress,
    }  # fmt: skip

    def law(speed_m_s: float) -> tuple[float, float]:
        return laws.restitution_at(speed_m_s)[:2]

    if not how.tuned:
        plain = nearest(best, law, with_drag=roles.has_drag)
        assisted = fit_engines(roles, plain, how.engines, helps=how.helps, **more)
        return plain, assisted, holdout.of_engines(closed, assisted), None
    wanted = goal_of(roles, best, law, [one.predicted for one in closed], how.step_s)
    tuned = tune_engines(roles, best, wanted, how.engines, **more)
    return wanted.plain, tuned, holdout.of_engines(closed, tuned), wanted


def _gather(
    file: ScenarioFile,
    request: FitRequest,
    fitted: BouncesFit,
    found: Sequence[EngineFit],
    scene: Scenario,
    recorded: Sequence[Stored],
) -> Result:
    sources = [
        run_record.of_source(one.engine, FITTED, [one.outcome])
        for one in found
        if one.outcome is not None
    ]
    scores = [score(row.name, *cell) for row in fitted.sources for cell in _cells(row)]
    record = record_of(file, scene, request, fitted, sources, scores)
    trajectories = [
        Stored(one.engine, FITTED, 0, run, FITTED, drop)
        for one in found
        for drop, (_, run) in enumerate(one.runs)
    ]
    return Result(record, (*recorded, *trajectories))


def _recorded(drops: Sequence[Impacts], best: Fit) -> list[Stored]:
    """What was measured over time, as it is drawn, and the closed form beside it."""
    stored = []
    for number, drop in enumerate(drops):
        if drop.signal is not None:
            time_s, values = decimated(drop.signal.time_s, drop.signal.values)
            signals = {drop.signal.name: values}
            measured = Trajectory(MEASURED, time_s, signals)
            stored.append(Stored(MEASURED, "", 0, measured, segment=number))
        time_s, height_m = plot_data.heights(best, number)
        truth = Trajectory(TRUTH, time_s, {HEIGHT: height_m})
        stored.append(Stored(TRUTH, "", 0, truth, FITTED, number))
    return stored


def _cells(row: BouncesEngine) -> list[tuple[str, Found]]:
    """What was found for one engine, by name."""
    return [
        *row.parameters.items(),
        *((f"effective_{name}", one) for name, one in row.effective.items()),
        *((one.name, one) for one in row.numbers),
    ]
