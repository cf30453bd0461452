"""The verb ``fit`` for scenarios whose parameters are told by signals over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from simcompare import units
from simcompare.comparison.comparison import INFO, Score
from simcompare.comparison.repeats import one_step_s
from simcompare.engine import engines
from simcompare.errors import InputError, UnknownName
from simcompare.fitting.waveforms import holdout, records
from simcompare.fitting.waveforms.engines import EngineWaves, fit_engines
from simcompare.fitting.waveforms.reference import Fitted, fit_reference
from simcompare.fitting.waveforms.setup import Setup, prepare
from simcompare.inference.reference_model import Model, model_of
from simcompare.inference.segments import INPUT, as_trajectory, inputs_of
from simcompare.inference.simulated import BEST, check_step, of_probes
from simcompare.model.trajectory import TRUTH
from simcompare.reports.fit import wave_words
from simcompare.results import run_record
from simcompare.results.fit_file import FITTED
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.fit_parts import finite
from simcompare.results.records.fit_waveforms import WaveHoldout
from simcompare.results.run import Stored
from simcompare.running.runner import TIME_LIMIT_S, Progress
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs.request import FitRequest
from simcompare.verbs.result import Result

#: mode under which fitted engines are recorded, and what measured signals are stored under
MEASURED = "measured"


def fit_waveform(
    file: ScenarioFile,
    request: FitRequest,
    given: Mapping[str, float],
    *,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Result:
    """Fits a scenario to recorded signals: reference first, then every engine's own parameters.

    Args:
        file: a scenario that can be fitted by waveform.
        request: what the user asked for; without unknowns that are named, those that the
            recording's plan calibrates, or all that the scenario names.
        given: parameters that the user sets; they are not fitted.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.

    Returns:
        The run; ``record.fit`` holds what was found.

    Raises:
        InputError: every fault of the request or of a recording.
    """
    chosen = engines.select(request.engine)
    model = model_of(file)
    if model.reference is None:
        raise InputError(file.name, ["has no reference.py, so its parameters cannot be fitted"])
    step_s = None if request.step is None else one_step_s(request.step)
    setup = prepare(
        file, list(map(str, request.recordings)), list(map(str, request.hold_out)),
        unknowns=request.unknowns, given=given, mapping=request.mapping,
    )  # fmt: skip
    check_step(model, setup.fitted, request.step, step_s)
    fitted = fit_reference(model, setup)
    found = fit_engines(
        model, setup, fitted, chosen, step_s=step_s, time_limit_s=time_limit_s, progress=progress
    )
    predicted = holdout.predict(model, setup, fitted, found, step_s)
    return _gather(model, setup, fitted, found, predicted, given, step_s, request)


def given_of(
    file: ScenarioFile,
    preset: str | None,
    fixed: Mapping[str, str | float],
    settings: Mapping[str, str | float],
    only_bounces: Mapping[str, object],
) -> dict[str, float]:
    """Parameters that the user sets, which are not fitted.

    Raises:
        InputError: an option that belongs to bounces.
        UnknownName: a preset or parameter that does not exist.
    """
    wrong = [option for option, value in only_bounces.items() if value]
    if wrong:
        raise InputError(
            ", ".join(wrong),
            [f"{file.name} is fitted by waveform, which this is not for; use --set for what is"
             " known, or say its uncertainty under validate: of the mapping file"],
        )  # fmt: skip
    if preset is not None and preset not in file.presets:
        raise UnknownName(f"preset of {file.name}", preset, file.presets)
    chosen = {} if preset is None else dict(file.presets[preset].set)
    return {**chosen, **file.read_settings(fixed, "--fix"), **file.read_settings(settings)}


def _gather(
    model: Model,
    setup: Setup,
    fitted: Fitted,
    found: Sequence[EngineWaves],
    predicted: WaveHoldout,
    given: Mapping[str, float],
    step_s: float | None,
    request: FitRequest,
) -> Result:
    sources = [run_record.of_source(one.engine, FITTED, one.outcomes) for one in found]
    best = fitted.estimate.as_dict()
    scene = model.scenario(setup.fitted[0], best, step_s)
    fit = records.of_fit(model, setup, fitted, found, predicted, given, scene.world.step_s)
    unit = units.symbol(scene.probes[setup.probes[0]].unit)
    fit = wave_words.worded(finite(fit), unit)
    scores = [
        Score(row.name, FITTED, name, "", None, one.value, None, one.u, one.unit, 1, None, None,
              INFO)
        for row in fit.sources for name, one in row.parameters.items()
    ]  # fmt: skip
    record = run_record.of_run(
        FitRecord, model.file, [scene], TRUTH, sources, scores, fit=fit,
        engines_asked=request.engine, scenario_asked=request.scenario,
        recording_asked=tuple(map(str, request.recordings)), command=request.command(),
    )  # fmt: skip
    return Result(record, tuple(_stored(model, setup, fitted, found, step_s)))


def _stored(
    model: Model,
    setup: Setup,
    fitted: Fitted,
    found: Sequence[EngineWaves],
    step_s: float | None,
) -> list[Stored]:
    """Measured, reference and engines, by probe."""
    stored = []
    every = dict(zip(setup.every, fitted.solution.values.tolist(), strict=True))
    own = [{**every, **start} for start in fitted.solution.starts]
    for number, case in enumerate((*setup.fitted, *setup.held)):
        values = own[number] if number < len(own) else fitted.estimate.as_dict()
        scene = model.scenario(case, values, step_s)
        truth = of_probes(scene, model.truth(scene), case.watched)
        stored.append(Stored(MEASURED, "", 0, as_trajectory(case), segment=number))
        stored += [Stored(INPUT, "", 0, driven, name, number)
                   for name, driven in inputs_of(case).items()]  # fmt: skip
        stored.append(Stored(TRUTH, "", 0, truth, FITTED, number))
    for one in found:
        for (number, variant), run in sorted(one.runs.items()):
            if variant == BEST:
                stored.append(Stored(one.engine, FITTED, 0, run, FITTED, number))
    return stored
