"""A run out of its simulations: scores, sources, and what sensors read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from simcompare.comparison import ablation
from simcompare.comparison.against import matches
from simcompare.comparison.comparison import Repeat, Score, scores_of
from simcompare.comparison.repeats import AtStep
from simcompare.engine.assist import NONE
from simcompare.engine.helps import known
from simcompare.errors import SimcompareError
from simcompare.hardware.recordings.bounce_table import BounceTable
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import TRUTH
from simcompare.results import run_record, sensing
from simcompare.results.records.run import Measurement, RunRecord
from simcompare.results.run import Stored
from simcompare.running.jobs import FAILED, OK, Outcome
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs.result import Result
from simcompare.verbs.run_plan import RunPlan, measured_units


def gathered(plan: RunPlan, outcomes: Sequence[Outcome], *, interrupted: bool) -> Result:
    """The run, as it is stored.

    Args:
        plan: what it did.
        outcomes: how every simulation ended.
        interrupted: whether it was ended early.
    """
    done = _gather(plan.file, plan.steps, [*outcomes, *plan.refused], plan.table)
    assert isinstance(done.record, RunRecord)
    request, helps = plan.request, plan.helps
    record = replace(
        done.record,
        engines_asked=request.engine,
        scenario_asked=request.scenario,
        against_asked=None if request.against is None else str(request.against),
        fit_asked=None if plan.fit is None else str(plan.fit.path),
        cautions=plan.cautions,
        assist=None if helps is None else known(helps) or NONE,
        judge=tuple(plan.judged),
        preset=plan.preset,
        interrupted=interrupted,
        command=request.command(),
    )
    return sensing.sensed(replace(done, record=record), plan.devices, request.seed)


def _gather(
    file: ScenarioFile,
    steps: Sequence[AtStep],
    outcomes: Sequence[Outcome],
    table: BounceTable | None,
) -> Result:
    scores: list[Score] = []
    trajectories: list[Stored] = []
    sources = []
    at_label = {at.label: at for at in steps}
    by_source: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in outcomes:
        if not outcome.job.without:
            by_source.setdefault((outcome.job.source, outcome.job.mode), []).append(outcome)
    for (source, mode), of_source in by_source.items():
        at = at_label[of_source[0].job.at]
        good = [outcome for outcome in of_source if outcome.status == OK]
        record = run_record.of_source(source, mode, of_source)
        if at.label:
            step_s = at.nominal.world.engine_step_s
            record = replace(record, engine=of_source[0].job.engine, engine_step_s=step_s)
        if len(good) == len(of_source):
            repeats = [
                Repeat(at.scenarios[o.job.repeat], o.trajectory, at.truths[o.job.repeat])
                for o in of_source
                if o.trajectory is not None
            ]
            try:
                scores += scores_of(repeats)
            except SimcompareError as error:  # this source lacks a signal; the others have it
                record = replace(record, status=FAILED, reason=str(error))
        trajectories += [
            Stored(source, mode, o.job.repeat, o.trajectory) for o in good if o.trajectory
        ]
        sources.append(record)
    finest = min(steps, key=lambda at: at.nominal.world.engine_step_s)
    for at in (finest, *(at for at in steps if at is not finest)):
        name = TRUTH if at is finest else f"{TRUTH}{at.label}"
        trajectories += [Stored(name, "", i, true) for i, true in enumerate(at.truths) if true]
    record_of_run = run_record.of_run(
        RunRecord, file, finest.scenarios, TRUTH if any(finest.truths) else None, sources, scores,
        steps=tuple(map(run_record.of_scenario_at, steps)) if len(steps) > 1 else (),
        without=tuple(row for at in steps for row in ablation.results_of(at, outcomes)),
        against=_against(file, table, scores, finest.nominal), beyond=finest.nominal.beyond,
    )  # fmt: skip
    return Result(record_of_run, tuple(trajectories))


def _against(
    file: ScenarioFile, table: BounceTable | None, scores: Sequence[Score], scene: Scenario
) -> Measurement | None:
    if table is None:
        return None
    matched = matches(table, scores, measured_units(scene))
    return run_record.of_measurement(file, table, matched)
