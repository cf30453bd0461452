"""The verb ``run``: a scenario through engines, held against the truth and against measurements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare import measures
from simcompare.arguments import checked
from simcompare.comparison import ablation
from simcompare.comparison.against import matches
from simcompare.comparison.comparison import Repeat, Score, scores_of
from simcompare.comparison.repeats import AtStep, at_steps, sample_steps_s
from simcompare.engine import engines
from simcompare.engine.assist import ALL, NONE
from simcompare.engine.helps import known
from simcompare.errors import InputError, SimcompareError
from simcompare.hardware.recordings import bounce_table
from simcompare.hardware.recordings.bounce_table import BounceTable
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, CONTACT_LEVELS, DEFAULT, TUNED, Settings
from simcompare.model.trajectory import TRUTH
from simcompare.results import run_record, sensing, store
from simcompare.results.records.run import Measurement, RunRecord
from simcompare.results.run import Stored
from simcompare.running.jobs import FAILED, OK, Job, Outcome
from simcompare.running.runner import TIME_LIMIT_S, Interrupted, Progress, run_jobs
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs import levels
from simcompare.verbs.notebook_line import with_line
from simcompare.verbs.request import RunRequest
from simcompare.verbs.result import Result

if TYPE_CHECKING:
    from simcompare.results.fit_file import FitFile


@checked
@with_line
def run(
    scenario: str | Path = "ball",
    *,
    engine: str | Sequence[str] = "all",
    contact: str | Sequence[str] = (DEFAULT, TUNED, ASSISTED),
    assist: str | Sequence[str] = ALL,
    judge: str | Sequence[str] = ASSISTED,
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    step: str | float | Sequence[str | float] | None = None,
    seeds: int | None = None,
    against: str | Path | None = None,
    sensor: Mapping[str, str | Path] | None = None,
    seed: int = 0,
    out: str | Path | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Result:
    """Simulates a scenario on engines and compares the results.

    ::

        run = simcompare.run("ball", engine="mujoco,pymunk", set={"drop_height": "30cm"})
        run.table("settling_time")
        run.plot("height_m").savefig("ball.pdf")

    Args:
        scenario: name, folder or file.
        engine: ``"all"``, names with commas or a list of names; "mujoco:rk4" is a variant.
        contact: contact levels, a list or a text with commas; also the fit.json of a fit, with
            which each engine runs with its own fitted parameters.
        assist: our helps in "assisted": "all", "none" or names (see ``simcompare.engine.helps``).
        judge: levels in which a tolerance that is missed is a failure of the run; "assisted"
            always is.
        set: parameters that differ from the file; text may carry a unit ("30cm").
        preset: named set of parameters, applied first.
        step: the engine's step, "1ms" or in seconds; samples may be coarser. Of several, as a list
            or a text with commas, each makes a source of its own, such as "pymunk@2ms".
        seeds: number of dithered repeats; the scenario's own where ``None``.
        against: table of measured bounces: a file or the name of a published one.
        sensor: sensor, joint, actuator or body, or one of their signals -> data sheet of a real
            one, in place of the scenario's ``errors``. Engines and scores stay ideal; what it reads
            is in ``readings``.
        seed: of all that is drawn for sensors.
        out: folder in which the run's own folder is made; nothing is stored where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(engine, done, total)``.

    Returns:
        The run; a run that Ctrl-C ended is marked so and keeps what had finished.

    Raises:
        SimcompareError: faults of the arguments or of a file, or nowhere to store the run.
    """
    scenario, engine = str(scenario), engines.listed(engine)
    chosen = engines.select(engine)
    modes, fit = levels.chosen_levels(contact)
    helps = levels.chosen_helps(assist, engine)
    levels.check_used(modes, helps, judge)
    judged = levels.judged_levels(judge, fit)
    request = RunRequest(
        scenario=scenario, engine=engine, contact=levels.names(contact),
        assist=levels.names(assist), judge=levels.names(judge), set=set, preset=preset, step=step,
        seeds=seeds, against=against, sensor=sensor, seed=seed,
    )  # fmt: skip
    file = catalogue.load(scenario)
    table = _table(file, against)
    values = {**({} if fit is None else fit.base(file)), **file.read_settings(set or {})}
    if table is not None:
        values, preset = with_conditions(file, table, values, preset)
    steps_s = sample_steps_s(file, values, preset, step)
    if seeds is not None and seeds < 1:
        raise InputError("--seeds", [f"{seeds} is not a number of repeats; expected 1 or more"])
    if seeds is not None and file.resolve(values, preset=preset).dither is None:
        raise InputError("--seeds", [f"{file.name} has nothing that is dithered between repeats"])
    usual_s = None if fit is None else fit.usual_step_s
    sources = len(chosen) * len(modes)
    steps = at_steps(file, values, preset, steps_s or [usual_s], seeds, sources)
    devices = sensing.asked_devices(steps[0].nominal, sensor or {}, seed)
    if out is not None:
        store.check_writable(Path(out))
    jobs = [
        job
        for name in chosen
        for mode in modes
        for at in steps
        for job in _jobs(file, name, mode, at, fit, helps)
    ]
    refused = [] if fit is None else levels.not_in_fit(jobs, fit, file)
    unfitted = {id(outcome.job) for outcome in refused}
    jobs = [job for job in jobs if id(job) not in unfitted]
    interrupted = False
    try:
        outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    except Interrupted as stop:
        outcomes, interrupted = stop.outcomes, True
    done = _gather(file, steps, [*outcomes, *refused], table)
    assert isinstance(done.record, RunRecord)
    record = replace(
        done.record,
        engines_asked=engine,
        scenario_asked=scenario,
        against_asked=None if against is None else str(against),
        fit_asked=None if fit is None else str(fit.path),
        cautions=() if fit is None else _cautions(fit, file, steps),
        assist=None if helps is None else known(helps) or NONE,
        judge=None if judged is None else tuple(judged),
        preset=preset,
        interrupted=interrupted,
        command=request.command(),
    )
    done = sensing.sensed(replace(done, record=record), devices, seed)
    return done if out is None else store.save(done, Path(out))


def with_conditions(
    file: ScenarioFile, table: BounceTable, values: Mapping[str, float], preset: str | None
) -> tuple[dict[str, float], str | None]:
    """Parameters and preset under which a table was measured, with what the user adds.

    Raises:
        InputError: the user, or the table, asks for another scenario, preset or condition.
    """
    measured = file.read_settings(table.parameters, str(table.path))
    faults = [
        f"{name} = {values[name]:g} is asked for, but the table was measured at {value:g}"
        for name, value in measured.items()
        if name in values and values[name] != value
    ]
    if preset is not None and table.preset is not None and preset != table.preset:
        faults.append(f"preset {preset} is asked for, but the table is of {table.preset}")
    scenario = table.head.get("scenario", file.name)
    if scenario != file.name:
        faults.append(f"the table is of the scenario {scenario}, not of {file.name}")
    if faults:
        raise InputError(f"--against {table.path.name}", faults)
    return {**measured, **values}, preset or table.preset


def _cautions(fit: FitFile, file: ScenarioFile, steps: Sequence[AtStep]) -> tuple[str, ...]:
    sentences = [one for at in steps for one in fit.cautions(at.nominal, file)]
    return tuple(dict.fromkeys(sentences))


def _jobs(
    file: ScenarioFile,
    engine: str,
    mode: str,
    at: AtStep,
    fit: FitFile | None,
    helps: frozenset[str] | None,
) -> list[Job]:
    """One job for each repeat; a fitted engine is given its own parameters.

    Assisted, the nominal repeat is run once more without each of the helps that act in it.
    """
    if fit is None or mode in CONTACT_LEVELS:
        settings = Settings(mode, helps=helps, drops=at.drops)
        jobs = [
            Job(engine, scene, settings, i, at=at.label) for i, scene in enumerate(at.scenarios)
        ]
        if mode == ASSISTED:
            jobs += ablation.jobs_of(engine, at, settings)
        return jobs
    fitted_jobs = []
    fitted = fit.settings(engine, at.nominal)
    for i, scene in enumerate(at.scenarios):
        for name, value in (fit.of_engine(engine, file) or {}).items():
            scene = file.vary(scene, name, value)
        fitted_jobs.append(Job(engine, scene, fitted, i, mode, at=at.label))
    return fitted_jobs


def _table(file: ScenarioFile, against: str | Path | None) -> BounceTable | None:
    if against is None:
        return None
    return bounce_table.read(bounce_table.find(str(against)), _measured_units(file.resolve()))


def _measured_units(scenario: Scenario) -> dict[str, str]:
    """Per-event quantities of a scenario's measures and their units."""
    by_name: dict[str, str] = {}
    for measure in scenario.measures:
        units = measures.units_of(measure, scenario)
        for name in measures.load(measure.function).series:
            by_name[measure.name_of(name)] = units[name]
    return by_name


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
    matched = matches(table, scores, _measured_units(scene))
    return run_record.of_measurement(file, table, matched)
