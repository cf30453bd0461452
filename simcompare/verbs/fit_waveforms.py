"""The verb ``fit`` for scenarios whose parameters are told by signals over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from simcompare import units
from simcompare.comparison.repeats import one_step_s
from simcompare.engine import engines
from simcompare.engine.assist import ALL
from simcompare.errors import InputError
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
from simcompare.results.records.fit_parts import finite
from simcompare.results.records.fit_waveforms import WaveHoldout
from simcompare.results.run import Stored
from simcompare.running.runner import Progress
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs.fitted import MEASURED, check_options, known, of_bounces, record_of, score
from simcompare.verbs.request import FitRequest
from simcompare.verbs.result import Result

_CURE = ", or say its uncertainty under validate: of the mapping file"


def fit_waveform(
    file: ScenarioFile,
    request: FitRequest,
    time_limit_s: float,
    progress: Progress | None,
) -> Result:
    """Fits a scenario to recorded signals: reference first, then every engine's own parameters.

    Without unknowns that are named, those are sought that the recording's plan calibrates, or all
    that the scenario names.
    """
    only = {**of_bounces(request), "--assist": request.assist not in (None, ALL)}
    check_options(file, only, "waveform", _CURE)
    given = known(file, request)
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
    scores = [score(one.name, *row) for one in fit.sources for row in one.parameters.items()]
    record = record_of(model.file, scene, request, fit, sources, scores, TRUTH)
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
