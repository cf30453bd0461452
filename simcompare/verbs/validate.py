"""The verb ``validate``: simulations against a recording of a real device, with uncertainty."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from simcompare.arguments import checked
from simcompare.comparison.comparison import INFO, Score
from simcompare.comparison.repeats import one_step_s
from simcompare.engine import engines
from simcompare.errors import UnknownName
from simcompare.inference import plan as plans
from simcompare.inference import sources, suspicions
from simcompare.inference.calibration import calibrated
from simcompare.inference.evaluated import Evaluated, evaluate
from simcompare.inference.reference_model import model_of
from simcompare.inference.segment_reader import segments_of
from simcompare.inference.segments import INPUT, as_trajectory, inputs_of
from simcompare.inference.simulated import (
    BEST,
    MOTION,
    NOMINAL,
    Engine,
    check_step,
    simulate,
)
from simcompare.model.settings import ASSISTED, CONTACT_LEVELS
from simcompare.model.trajectory import TRUTH, Trajectory
from simcompare.reports.validation import answer
from simcompare.results import run_record, store
from simcompare.results.records.validation import ValidationRecord, ValueRecord
from simcompare.results.run import Stored
from simcompare.running.runner import TIME_LIMIT_S, Progress
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.validation import records
from simcompare.validation.records import Compared
from simcompare.validation.tabled import tables
from simcompare.verbs import levels
from simcompare.verbs.notebook_line import with_line
from simcompare.verbs.request import ValidateRequest
from simcompare.verbs.result import Result
from simcompare.verbs.tabled import Tabled
from simcompare.verbs.validate_table import validate_table

#: what measured trajectories are stored under
MEASURED = "measured"


@checked
@with_line
def validate(
    scenario: str | Path,
    *,
    recording: str | Path,
    engine: str | Sequence[str] = "all",
    contact: str = ASSISTED,
    mapping: str | Path | None = None,
    set: Mapping[str, str | float] | None = None,
    streams: str | Sequence[str] = (),
    step: str | float | None = None,
    strict: bool = False,
    out: str | Path | None = None,
    trust: bool = False,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Result | Tabled:
    """Holds simulations against a recording, or against a table of results.

    ::

        found = simcompare.validate("pendulum", recording="pendulum_free_swing", engine="mujoco")
        found.table()  # how far the simulation is from the recording
        found.report(open=True)
        simcompare.validate("pendulum", recording="periods.csv")  # lengths and periods

    Args:
        scenario: name, folder or file.
        recording: a public data set, the folder of an imported recording, a log, or a table with
            one experiment in each row.
        engine: ``"all"``, names with commas or a list of names.
        contact: contact level.
        mapping: mapping file, whose ``validate:`` says which channel is which quantity.
        set: parameters that replace what is known before.
        streams: streams that are judged; those of the plan where empty.
        step: time between samples, "1ms" or in seconds.
        strict: refuse a log with any defect.
        out: folder in which the run's own folder is made; nothing is stored where ``None``.
        trust: run the Python files beside the scenario, where it comes from elsewhere; a yes is
            remembered until they change.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(engine, done, total)``.

    Returns:
        The run; ``record.validation`` holds what was found. Of a table of results, what was found
        itself.

    Raises:
        SimcompareError: faults of the arguments, of a file or of the plan.
    """
    scenario, engine = str(scenario), engines.listed(engine)
    recording, streams = str(recording), levels.names(streams)
    if contact not in CONTACT_LEVELS:
        raise UnknownName("contact level", contact, CONTACT_LEVELS)
    chosen = engines.select(engine)
    file = catalogue.load(scenario, trust=trust)
    if out is not None:
        store.check_writable(Path(out))
    request = ValidateRequest(
        scenario=scenario, engine=engine, set=set, step=step, recording=recording, contact=contact,
        mapping=mapping, streams=tuple(streams), strict=strict,
    )  # fmt: skip
    table = tables.of(Path(recording), file, None if mapping is None else Path(mapping))
    if table is not None:
        return validate_table(
            table, file, request, chosen, out=None if out is None else Path(out),
            time_limit_s=time_limit_s, progress=progress,
        )  # fmt: skip
    source = sources.find(recording, mapping=mapping, strict=strict)
    command = plans.template_command(scenario, recording, mapping)
    plan = plans.choose(source.plans, file.name, command)
    plan = plans.checked(plan, file.resolve(), source.plans)
    overrides = file.read_settings(set or {})
    step_s = None if step is None else one_step_s(step)
    model = model_of(file)
    segments = segments_of(file, plan, source.recording, streams or plan.streams, overrides)
    check_step(model, segments, step, step_s)
    fit = calibrated(model, plan, source, overrides, mapping)
    fitted = {} if fit is None else fit.as_dict()
    doubt = suspicions.suspected(
        model, plan, source.recording, [one.stream for one in segments], overrides, fitted
    )
    evaluated = [evaluate(model, plan, segment, fit, step_s) for segment in segments]
    simulated = simulate(
        model, segments, None if fit is None else fit.as_dict(), chosen, contact=contact,
        step_s=step_s, time_limit_s=time_limit_s, progress=progress,
    )  # fmt: skip
    done = _run_of(request, file, Compared(source, plan, fit, evaluated, simulated, doubt))
    return done if out is None else store.save(done, Path(out))


def _run_of(request: ValidateRequest, file: ScenarioFile, done: Compared) -> Result:
    validation = answer.with_words(records.of_validation(done))
    record = run_record.of_run(
        ValidationRecord,
        file,
        [done.segments[0].scene],
        None if done.segments[0].truth is None else TRUTH,
        [run_record.of_source(e.name, request.contact, e.outcomes) for e in done.engines],
        [_score(row, request.contact) for row in validation.values],
        validation=validation,
        engines_asked=request.engine,
        scenario_asked=request.scenario,
        recording_asked=str(request.recording),
        command=request.command(),
    )
    return Result(record, tuple(_stored(done.segments, done.engines, request.contact)))


def _score(row: ValueRecord, contact: str) -> Score:
    return Score(
        row.source, contact, row.measure, row.probe, None, row.simulated, None, row.u_simulated,
        row.unit, 1, None, 2 * row.u_val if row.e_n is not None else None, INFO,
        measured=row.measured,
    )  # fmt: skip


def _stored(
    segments: Sequence[Evaluated], engines: Sequence[Engine], contact: str
) -> Iterator[Stored]:
    """Measured, reference and engines."""
    for number, one in enumerate(segments):
        if one.segment.observed:
            yield Stored(MEASURED, "", 0, as_trajectory(one.segment), segment=number)
        for name, driven in inputs_of(one.segment).items():
            yield Stored(INPUT, "", 0, driven, name, number)
        if one.truth is not None:
            bands = {f"u({probe})": one.u_input(probe) for probe in one.segment.observed}
            signals = {**one.truth.signals, **{k: v for k, v in bands.items() if v is not None}}
            truth = Trajectory(TRUTH, one.truth.time_s, signals)
            yield Stored(TRUTH, "", 0, truth, BEST, number)
        if one.nominal is not None:
            yield Stored(TRUTH, "", 0, one.nominal, NOMINAL, number)
    for engine in engines:
        for (number, variant), run in engine.runs.items():
            if variant in (BEST, NOMINAL):
                yield Stored(engine.name, contact, 0, run, variant, number)
        if engine.motion is not None and engine.motion.signals:
            yield Stored(engine.name, contact, 0, engine.motion, MOTION)
