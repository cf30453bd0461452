"""The verb ``run``: a scenario through engines, held against the truth and against measurements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simcompare import ablation, catalogue, engines, levels, measures, run_record, units
from simcompare.against import Match, matches
from simcompare.assist import ALL, NONE
from simcompare.compare import Repeat, Score, scores_of
from simcompare.engine.drives import input_values
from simcompare.engine.helps import known
from simcompare.engine.sensing import complete
from simcompare.engine.simulation import sample_times
from simcompare.errors import InputError, OutputError, SimcompareError
from simcompare.jobs import FAILED, OK, Job, Outcome
from simcompare.results import TRUTH, Run, Stored
from simcompare.runner import TIME_LIMIT_S, Interrupted, Progress, run_jobs
from simcompare.scenario import MOST_SAMPLES, Scenario
from simcompare.settings import (
    ASSISTED,
    CONTACT_LEVELS,
    DEFAULT,
    TUNED,
    DropPlan,
    Settings,
)
from simcompare.trajectory import Trajectory
from simcompare.tuning.plan import drop_plans

if TYPE_CHECKING:
    from simcompare.fitting.fit_file import FitFile
    from simcompare.hardware.logs.bounce_table import BounceTable
    from simcompare.scenario_file import ScenarioFile

#: samples below which a run shows nothing
LEAST_SAMPLES = 100


def run(
    scenario: str = "ball",
    *,
    engine: str = "all",
    contact: str | Sequence[str] = (DEFAULT, TUNED, ASSISTED),
    assist: str | Sequence[str] = ALL,
    judge: str | Sequence[str] = ASSISTED,
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    step: str | float | None = None,
    seeds: int | None = None,
    against: str | Path | None = None,
    out: str | Path | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Run:
    """Simulates a scenario on engines and compares the results.

    Args:
        scenario: name, folder or file.
        engine: ``"all"`` or names with commas.
        contact: contact levels, a list or a text with commas; also the fit.json of a fit, with
            which each engine runs with its own fitted parameters.
        assist: our helps in "assisted": "all", "none" or names (see ``simcompare.engine.helps``).
        judge: levels in which a tolerance that is missed is a failure of the run; "assisted"
            always is.
        set: parameters that differ from the file; text may carry a unit ("30cm").
        preset: named set of parameters, applied first.
        step: the engine's step, "1ms" or in seconds; samples may be coarser.
        seeds: number of dithered repeats; the scenario's own where ``None``.
        against: table of measured bounces: a file or the name of a published one.
        out: folder in which the run's own folder is made; nothing is stored where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(engine, done, total)``.

    Returns:
        The run; a run that Ctrl-C ended is marked so and keeps what had finished.

    Raises:
        SimcompareError: faults of the arguments or of a file, or nowhere to store the run.
    """
    chosen = engines.select(engine)
    modes, fit = levels.chosen_levels(contact)
    helps = levels.chosen_helps(assist, engine)
    levels.check_used(modes, helps, judge)
    judged = levels.judged_levels(judge, fit)
    file = catalogue.load(scenario)
    table = _table(file, against)
    values = {**({} if fit is None else fit.base(file)), **file.read_settings(set or {})}
    if table is not None:
        values, preset = with_conditions(file, table, values, preset)
    step_s = None if fit is None else fit.usual_step_s
    if step is not None:
        step_s = sample_step_s(file, values, preset, step)
    if seeds is not None and seeds < 1:
        raise InputError("--seeds", [f"{seeds} is not a number of repeats; expected 1 or more"])
    if seeds is not None and file.resolve(values, preset=preset).dither is None:
        raise InputError("--seeds", [f"{file.name} has nothing that is dithered between repeats"])
    scenarios = repeats_of(file, values, preset, step_s, seeds)
    truths = truths_of(file.path, scenarios)
    if out is not None:
        check_writable(Path(out))
    nominal = scenarios[len(scenarios) // 2]
    drops = drop_plans(nominal)
    jobs = [
        job
        for name in chosen
        for mode in modes
        for job in _jobs(file, name, mode, scenarios, (fit, helps, drops))
    ]
    interrupted = False
    try:
        outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    except Interrupted as stop:
        outcomes, interrupted = stop.outcomes, True
    done = _gather(file, (scenarios, truths), outcomes, table)
    done.record.update(
        engines_asked=engine,
        scenario_asked=scenario,
        against_asked=None if against is None else str(against),
        fit_asked=None if fit is None else str(fit.path),
        cautions=[] if fit is None else fit.cautions(nominal, file, chosen),
        assist=None if helps is None else known(helps) or NONE,
        judge=judged,
        preset=preset,
        interrupted=interrupted,
    )
    result = Run(done.record, tuple(done.scores), tuple(done.trajectories), None, interrupted)
    if out is None:
        return result
    from simcompare import store

    return store.save(result, Path(out))


def repeats_of(
    file: ScenarioFile,
    values: Mapping[str, float],
    preset: str | None,
    step_s: float | None,
    count: int | None,
) -> list[Scenario]:
    """The scenario once for every dithered repeat, the nominal one at index n//2.

    The dithered parameter takes the values p + (i - n//2)/n · span for i = 0 … n-1.

    Raises:
        InputError: values out of bounds, or a step so long that the spread leaves what makes sense.
    """
    nominal = file.resolve(values, preset=preset, step_s=step_s)
    dither = nominal.dither
    if dither is None:
        return [nominal]
    count = dither.count if count is None else count
    centre = nominal.parameters[dither.parameter]
    if dither.span >= 2 * centre and file.parameters[dither.parameter].min >= 0:
        raise InputError(
            "--step",
            [
                f"{nominal.world.step_s:g} s spreads {dither.parameter} by {dither.span:.3g}"
                f" about {centre:.3g}, below 0; use a shorter step"
            ],
        )
    offsets = [(i - count // 2) / count * dither.span for i in range(count)]
    return [
        file.vary(nominal, dither.parameter, centre + offset) if offset else nominal
        for offset in offsets
    ]


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


def check_writable(folder: Path) -> None:
    """Makes the output folder and proves that it can be written to, before anything is simulated.

    Raises:
        OutputError: it cannot.
    """
    probe = folder / ".simcompare-write-test"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        raise OutputError(
            f"--out {folder}: cannot be written to ({error.strerror}); choose another folder"
        ) from None


def sample_step_s(
    file: ScenarioFile, values: Mapping[str, float], preset: str | None, step: str | float
) -> float:
    """Time between samples for an engine's step; they are as much coarser as the scenario says.

    Raises:
        InputError: a step that makes no sense in the scenario; says which do.
    """
    own = file.resolve(values, preset=preset)
    step_s = units.to_si(step, "s", "--step") * own.world.substeps
    _check_step(own, step_s)
    return step_s


def _check_step(scenario: Scenario, step_s: float) -> None:
    if step_s <= 0:
        raise InputError("--step", [f"{step_s:g} s is not a time above 0"])
    duration, parts = scenario.world.duration_s, scenario.world.substeps
    shortest, longest = duration / MOST_SAMPLES, duration / LEAST_SAMPLES
    if not shortest <= step_s <= longest:
        raise InputError(
            "--step",
            [
                f"{step_s / parts:g} s gives {duration / step_s:.3g} samples in {duration:.3g} s;"
                f" use {shortest / parts:.2g} s to {longest / parts:.2g} s"
            ],
        )


def _jobs(
    file: ScenarioFile,
    engine: str,
    mode: str,
    scenarios: Sequence[Scenario],
    given: tuple[FitFile | None, frozenset[str] | None, tuple[DropPlan, ...]],
) -> list[Job]:
    """One job for each repeat; a fitted engine is given its own parameters.

    Assisted, the nominal repeat is run once more without each of the helps that act in it.
    """
    fit, helps, drops = given
    if fit is None or mode in CONTACT_LEVELS:
        settings = Settings(mode, helps=helps, drops=drops)
        jobs = [Job(engine, scene, settings, i) for i, scene in enumerate(scenarios)]
        if mode == ASSISTED:
            jobs += ablation.jobs_of(engine, scenarios, settings)
        return jobs
    found = []
    fitted = fit.settings(engine, scenarios[len(scenarios) // 2])
    for i, scene in enumerate(scenarios):
        for name, value in (fit.of_engine(engine, file) or {}).items():
            scene = file.vary(scene, name, value)
        found.append(Job(engine, scene, fitted, i, mode))
    return found


def _table(file: ScenarioFile, against: str | Path | None) -> BounceTable | None:
    if against is None:
        return None
    from simcompare.hardware.logs import bounce_table

    return bounce_table.read(bounce_table.find(str(against)), _measured_units(file.resolve()))


def _measured_units(scenario: Scenario) -> dict[str, str]:
    """Per-event quantities of a scenario's measures and their units."""
    found: dict[str, str] = {}
    for measure in scenario.measures:
        units = measures.units_of(measure, scenario)
        for name in measures.load(measure.function).SERIES:
            found[measure.names.get(name, name)] = units[name]
    return found


@dataclass
class _Gathered:
    record: dict[str, Any]
    scores: list[Score]
    trajectories: list[Stored]


def _gather(
    file: ScenarioFile,
    planned: tuple[Sequence[Scenario], Sequence[Trajectory | None]],
    outcomes: Sequence[Outcome],
    table: BounceTable | None,
) -> _Gathered:
    scenarios, truths = planned
    scores: list[Score] = []
    trajectories: list[Stored] = []
    sources = []
    by_source: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in outcomes:
        if not outcome.job.without:
            by_source.setdefault((outcome.job.engine, outcome.job.mode), []).append(outcome)
    for (engine, mode), own in by_source.items():
        good = [outcome for outcome in own if outcome.status == OK]
        record = run_record.of_source(engine, mode, own)
        if len(good) == len(own):
            repeats = [
                Repeat(scenarios[o.job.repeat], o.trajectory, truths[o.job.repeat])
                for o in own
                if o.trajectory is not None
            ]
            try:
                scores += scores_of(repeats)
            except SimcompareError as error:  # this source lacks a signal; the others have it
                record.update(status=FAILED, reason=str(error))
        trajectories += [
            Stored(engine, mode, o.job.repeat, o.trajectory) for o in good if o.trajectory
        ]
        sources.append(record)
    trajectories += [Stored(TRUTH, "", i, true) for i, true in enumerate(truths) if true]
    found: list[Match] = []
    if table is not None:
        found = matches(table, scores, _measured_units(scenarios[0]))
    truth = TRUTH if any(truths) else None
    record = run_record.of_run(file, scenarios, truth, sources, scores)
    record["without"] = ablation.results_of(scenarios, truths, outcomes)
    record["against"] = run_record.of_measurement(file, table, found) if table is not None else None
    return _Gathered(record, scores, trajectories)


def truths_of(path: Path, scenarios: Sequence[Scenario]) -> list[Trajectory | None]:
    """The truth of every repeat, ``None`` where the scenario has no reference.

    Raises:
        InputError: the reference fails or returns what cannot be a truth.
    """
    reference = catalogue.reference_of(path)
    if reference is None:
        return [None] * len(scenarios)
    try:
        return [_truth(reference, scenario) for scenario in scenarios]
    except InputError:  # it refuses these parameters, and says why
        raise
    # a user's own code may raise anything, also SystemExit
    except (Exception, SystemExit) as error:
        where = str(path.with_name("reference.py"))
        message = f"reference() failed: {type(error).__name__}: {error}"
        raise InputError(where, [message]) from error


def _truth(reference: catalogue.Reference, scenario: Scenario) -> Trajectory:
    times = sample_times(scenario)
    signals = dict(reference(scenario.parameters, times, scenario.inputs))
    complete(scenario, times, signals, input_values(scenario, times))
    truth = Trajectory(TRUTH, times, signals)
    for measure in scenario.measures:
        for probe in (measure.probe, *measure.also.values()):
            measures.observe(truth, scenario.probes[probe])
    return truth
