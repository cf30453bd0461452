"""The verb ``fit``: parameters from measurements, on every engine, with uncertainty."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simcompare.arguments import checked
from simcompare.comparison.comparison import INFO, Score
from simcompare.comparison.repeats import sample_step_s
from simcompare.engine import engines
from simcompare.engine.assist import ALL, NONE
from simcompare.engine.helps import known
from simcompare.errors import InputError
from simcompare.fitting.bounces import bounce_models, holdout, model_selection, plot_data, records
from simcompare.fitting.bounces.arcs import rejoined
from simcompare.fitting.bounces.assisted_fit import fit_engines
from simcompare.fitting.bounces.engine_fit import EngineFit
from simcompare.fitting.bounces.identifiability import identifiability
from simcompare.fitting.bounces.impacts import HEIGHT, Impacts
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.reading import drops_of
from simcompare.fitting.bounces.request import (
    Constraints,
    candidates,
    check_request,
    given_of,
    numbers_of,
)
from simcompare.fitting.bounces.roles import Roles, roles_of
from simcompare.fitting.bounces.tune_engines import tune_engines
from simcompare.fitting.bounces.tuning_goal import TuningGoal, goal_of
from simcompare.fitting.bounces.unknowns import SPEED
from simcompare.model import plain
from simcompare.model.fittable import TOSSES, WAVEFORM
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, TUNED
from simcompare.model.trajectory import TRUTH, Trajectory
from simcompare.reports.fit import answer, identifiability_words
from simcompare.reports.render.decimation import decimated
from simcompare.results import run_record, store
from simcompare.results.fit_file import FITTED
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_engines import BouncesEngine, EffectiveValue, Number
from simcompare.results.records.fit_forms import Prior
from simcompare.results.records.fit_holdout import Holdout
from simcompare.results.records.fit_parts import EngineParameter, finite
from simcompare.results.run import Stored
from simcompare.running.runner import TIME_LIMIT_S, Progress
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs import fit_tosses, fit_waveforms, levels
from simcompare.verbs.notebook_line import with_line
from simcompare.verbs.request import FitRequest
from simcompare.verbs.result import Result

#: what measured signals are stored under
MEASURED = "measured"


@checked
@with_line
def fit(
    scenario: str | Path = "ball",
    *,
    recordings: str | Path | Sequence[str | Path],
    hold_out: str | Path | Sequence[str | Path] = (),
    engine: str | Sequence[str] = "all",
    model: str = "auto",
    unknowns: str | Sequence[str] = (),
    fixed: Mapping[str, str | float] | None = None,
    priors: Mapping[str, tuple[float, float]] | None = None,
    u_time_s: float | None = None,
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    mapping: str | Path | None = None,
    step: str | float | None = None,
    assist: str | Sequence[str] | None = None,
    out: str | Path | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Result:
    """Fits a scenario to a measurement: to impacts and heights, signals over time, or tosses.

    ::

        fit = simcompare.fit("pendulum", recordings=["pendulum_free_swing"], engine="mujoco")
        fit.table()  # parameters with their uncertainty
        fit.plot()  # measured and simulated

    Args:
        scenario: name, folder or file of a scenario that says under ``fit:`` how it is fitted.
        recordings: log, stored recording, public data set or bounce table that is fitted; a list
            of several.
        hold_out: the same, which are not fitted but predicted.
        engine: ``"all"``, names with commas or a list of names.
        model: closed form, or "auto": the one with the least AICc.
        unknowns: what is fitted beside what the model has, such as "clock_skew"; by waveform
            and by tosses, all that is fitted.
        fixed: values of what is not fitted; by tosses also the "scale" of measured lengths.
        priors: unknown -> value and standard uncertainty.
        u_time_s: standard uncertainty of an impact time, where a recording does not say [s].
        set: parameters of the scenario, such as the ball's mass.
        preset: named set of parameters, applied first.
        mapping: mapping file for the logs.
        step: the engine's step, which engines are tuned for; the scenario's own where ``None``.
        assist: our helps with which engines are run: "none", for which bounces are fitted if
            nothing is said, "all", or names (``simcompare.engine.helps``); by waveform always
            "all", by tosses too if nothing is said.
        out: folder in which the run's own folder is made; nothing is stored where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.

    Returns:
        The run; ``record.fit`` holds what was found, and goes into fit.json.

    Raises:
        InputError: every fault of the request or of a recording.
    """
    scenario, engine = str(scenario), engines.listed(engine)
    recordings, hold_out = _listed(recordings), _listed(hold_out)
    unknowns = levels.names(unknowns)
    options = FitRequest(
        scenario=scenario, recordings=tuple(recordings), hold_out=tuple(hold_out), engine=engine,
        model=model, unknowns=tuple(unknowns), fixed=fixed, priors=priors, u_time_s=u_time_s,
        set=set, preset=preset, mapping=mapping, step=step, assist=assist,
    )  # fmt: skip
    chosen = engines.select(engine)
    file = catalogue.load(scenario)
    if not recordings:
        raise InputError("--recording", ["no recording is given; give at least one"])
    if file.fit is None:
        raise InputError(
            scenario,
            ["names nothing that can be fitted; expected fit: {by: bounces|waveform|tosses, …}"],
        )
    if out is not None:
        store.check_writable(Path(out))
    if file.fit.by == WAVEFORM:
        only = {"--prior": priors, "--model": model != "auto", "--u-time": u_time_s is not None,
                "--assist": assist not in (None, ALL)}  # fmt: skip
        set_by_user = fit_waveforms.given_of(file, preset, fixed or {}, set or {}, only)
        done = fit_waveforms.fit_waveform(
            file, options, set_by_user, time_limit_s=time_limit_s, progress=progress
        )
        return _saved(done, out)
    if file.fit.by == TOSSES:
        done = fit_tosses.fit_tosses(file, options, time_limit_s=time_limit_s, progress=progress)
        return _saved(done, out)
    helps = levels.chosen_helps(NONE if assist is None else assist, engine)
    given = given_of(file, set, preset)
    step_s = None if step is None else sample_step_s(file, given, None, step)
    roles = roles_of(file, given)
    constraints = Constraints(
        extra=tuple(unknowns),
        fixed=roles.known(numbers_of(fixed or {})),
        priors={name: Prior(value, u) for name, (value, u) in (priors or {}).items()},
    )
    check_request(recordings, hold_out, u_time_s, roles, file.read_settings(set or {}))
    reading = (mapping, u_time_s, constraints.fixed.get("gravity_m_s2", bounce_models.GRAVITY))
    drops = [drop for name in recordings for drop in drops_of(name, *reading)]
    held = [drop for name in hold_out for drop in drops_of(name, *reading)]
    choice = model_selection.compare(
        drops,
        candidates(model, constraints),
        extra=constraints.extra,
        fixed=constraints.fixed,
        priors=constraints.priors,
    )
    known = identifiability(choice.best)
    if constraints.extra and known.is_blind:
        filmed = any(drop.track for drop in drops)
        words = identifiability_words.of_bounces(known, constraints.priors, filmed=filmed)
        raise InputError("--unknown", [*words, "leave it out, or --fix what it mixes with"])
    how = _How(chosen, helps, step_s, time_limit_s, progress)
    start, found, predicted, wanted = _engines(roles, choice, drops, held, constraints, how)
    scene = file.resolve(roles.values(start.problem.values(start.x, 0)), step_s=step_s)
    found_fit = records.of_fit(
        roles, choice, start, found, predicted, (drops, held),
        records.Made(TUNED if how.tuned else ASSISTED, how.assist, wanted, scene),
    )  # fmt: skip
    about = {
        "engines_asked": engine, "scenario_asked": scenario, "command": options.command(),
        "recording_asked": tuple(map(str, recordings)),
    }  # fmt: skip
    recorded = _recorded(drops, choice.best)
    return _saved(
        _gather(file, answer.worded(finite(found_fit)), found, about, scene, recorded), out
    )


def _listed(recordings: str | Path | Sequence[str | Path]) -> Sequence[str | Path]:
    return [recordings] if isinstance(recordings, str | Path) else recordings


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
    choice: model_selection.Choice,
    drops: Sequence[Impacts],
    held: Sequence[Impacts],
    constraints: Constraints,
    how: _How,
) -> tuple[Fit, Sequence[EngineFit], Holdout, TuningGoal | None]:
    """The closed form that engines get, what they make of it, and held-out drops."""
    closed = holdout.predict(choice.best, held, constraints.fixed)
    more: dict[str, Any] = {
        "step_s": how.step_s, "time_limit_s": how.time_limit_s, "progress": how.progress,
    }  # fmt: skip
    if how.tuned:
        best = choice.best
        wanted = goal_of(roles, best, [one.predicted for one in closed])
        tuned = tune_engines(roles, best, wanted, how.engines, **more)
        return best, tuned, holdout.of_engines(closed, closed, tuned), wanted
    start = _for_engines(roles, choice.best, _joined(choice.best, drops, constraints), constraints)
    assisted = fit_engines(roles, start, how.engines, helps=how.helps, **more)
    other = closed if start is choice.best else holdout.predict(start, held, constraints.fixed)
    return start, assisted, holdout.of_engines(closed, other, assisted), None


def _saved(done: Result, out: str | Path | None) -> Result:
    if out is None:
        return done
    saved = store.save(done, Path(out))
    assert saved.folder is not None
    assert isinstance(saved.record, FitRecord)
    (saved.folder / "fit.json").write_text(
        plain.text(saved.record.fit, indent=1) + "\n", encoding="utf-8"
    )
    return saved


def _joined(best: Fit, drops: Sequence[Impacts], constraints: Constraints) -> list[Impacts]:
    """Impacts of videos where arcs with the drag that was found meet, and not parabolas."""
    speed = best.as_dict().get(SPEED, constraints.fixed.get(SPEED, math.inf))
    if not math.isfinite(speed):
        return list(drops)
    gravity = float(constraints.fixed.get("gravity_m_s2", bounce_models.GRAVITY))
    return [drop if drop.track is None else rejoined(drop, speed, gravity) for drop in drops]


def _for_engines(
    roles: Roles, best: Fit, drops: Sequence[Impacts], constraints: Constraints
) -> Fit:
    """The fit with the contact that engines have: a restitution that does not depend on speed."""
    model = bounce_models.model_of(best.model)
    with_drag = (model.drag or SPEED in constraints.fixed) and roles.has_drag
    given = model.law == "constant" and (roles.has_drag or not model.drag)
    if given and all(drop.track is None for drop in drops):
        return best
    name = "constant+drag" if with_drag else "constant"
    priors = {n: prior for n, prior in constraints.priors.items() if n != "exponent"}
    fixed = {n: value for n, value in constraints.fixed.items() if n != "exponent"}
    return model_selection.compare(
        drops, [name], extra=constraints.extra, fixed=fixed, priors=priors
    ).best


def _gather(
    file: ScenarioFile,
    fitted: BouncesFit,
    found: Sequence[EngineFit],
    told: Mapping[str, Any],
    scene: Scenario,
    recorded: Sequence[Stored],
) -> Result:
    sources = [
        run_record.of_source(one.engine, FITTED, [one.outcome])
        for one in found
        if one.outcome is not None
    ]
    scores = [score for row in fitted.sources for score in _scores(row)]
    record = run_record.of_run(FitRecord, file, [scene], None, sources, scores, fit=fitted, **told)
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


def _scores(row: BouncesEngine) -> list[Score]:
    """What was found for one engine, as scores that are shown and not judged."""
    cells: list[tuple[str, EngineParameter | EffectiveValue | Number]] = [
        *row.parameters.items(),
        *((f"effective_{name}", one) for name, one in row.effective.items()),
        *((one.name, one) for one in row.numbers),
    ]
    return [Score(row.name, FITTED, name, "", None, one.value, None, one.u, one.unit, 1, None, None,
                  INFO) for name, one in cells]  # fmt: skip
