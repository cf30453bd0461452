"""The verb ``fit`` for scenarios whose parameters are told by signals over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from simcompare import units
from simcompare.compare.comparison import INFO, Score
from simcompare.engine import engines
from simcompare.errors import InputError, UnknownName
from simcompare.fitting.waveforms import holdout, records
from simcompare.fitting.waveforms.engines import EngineWaves, fit_engines
from simcompare.fitting.waveforms.reference import Fitted, fit_reference
from simcompare.fitting.waveforms.setup import Setup, prepare
from simcompare.inference.reference_model import Model, model_of
from simcompare.inference.segments import as_trajectory
from simcompare.inference.simulated import BEST, of_probes
from simcompare.model.trajectory import TRUTH
from simcompare.reports.fit import wave_words
from simcompare.results import run_record
from simcompare.results.fit_file import FITTED
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.fit_parts import finite
from simcompare.results.records.fit_waveforms import WaveHoldout
from simcompare.results.run import Run, Stored
from simcompare.running.runner import TIME_LIMIT_S, Progress
from simcompare.scenarios.scenario_file import ScenarioFile

#: mode under which fitted engines are recorded, and what measured signals are stored under
MEASURED = "measured"


def fit_waveform(
    file: ScenarioFile,
    *,
    recordings: Sequence[str | Path],
    hold_out: Sequence[str | Path] = (),
    engine: str = "all",
    unknowns: Sequence[str] = (),
    given: Mapping[str, float] | None = None,
    mapping: str | Path | None = None,
    step: str | float | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Run:
    """Fits a scenario to recorded signals: reference first, then every engine's own parameters.

    Args:
        file: a scenario that can be fitted by waveform.
        recordings: logs, stored recordings, or public data sets that are fitted.
        hold_out: the same, which are not fitted but predicted.
        engine: ``"all"`` or names with commas.
        unknowns: what is sought; what the recording's plan calibrates, or all that the scenario
            names, where empty.
        given: parameters that the user sets; they are not sought.
        mapping: mapping file for the logs.
        step: time between samples.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.

    Returns:
        The run; ``record["fit"]`` holds what was found.

    Raises:
        InputError: every fault of the request or of a recording.
    """
    chosen = engines.select(engine)
    model = model_of(file)
    if model.reference is None:
        raise InputError(file.name, ["has no reference.py, so its parameters cannot be fitted"])
    step_s = None if step is None else units.to_si(step, "s", "--step")
    setup = prepare(
        file, [str(name) for name in recordings], [str(name) for name in hold_out],
        unknowns=unknowns, given=given or {}, mapping=mapping,
    )  # fmt: skip
    fitted = fit_reference(model, setup)
    found = fit_engines(
        model, setup, fitted, chosen, step_s=step_s, time_limit_s=time_limit_s, progress=progress
    )
    predicted = holdout.predict(model, setup, fitted, found, step_s)
    words = ["simcompare", "fit", file.name]
    words += [word for name in recordings for word in ("--recording", str(name))]
    words += [word for name in hold_out for word in ("--hold-out", str(name))]
    words += ["--engine", engine] + (["--unknown", ",".join(unknowns)] if unknowns else [])
    words += [w for name, value in (given or {}).items() for w in ("--set", f"{name}={value}")]
    words += ["--map", str(mapping)] if mapping is not None else []
    words += ["--step", str(step)] if step is not None else []
    asked = _Asked(engine, tuple(map(str, recordings)), words)
    return _gather(model, setup, fitted, found, predicted, given or {}, step_s, asked)


@dataclass(frozen=True)
class _Asked:
    """What the user asked for: engines, recordings, and the words to ask for it again."""

    engine: str
    recordings: tuple[str, ...]
    command: Sequence[str]


def given_of(
    file: ScenarioFile,
    preset: str | None,
    fixed: Mapping[str, str | float],
    settings: Mapping[str, str | float],
    only_bounces: Mapping[str, object],
) -> dict[str, float]:
    """Parameters that the user sets, which are not sought.

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
    return {**chosen, **file.read_settings({**fixed, **settings})}


def _gather(
    model: Model,
    setup: Setup,
    fitted: Fitted,
    found: Sequence[EngineWaves],
    predicted: WaveHoldout,
    given: Mapping[str, float],
    step_s: float | None,
    asked: _Asked,
) -> Run:
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
        engines_asked=asked.engine, scenario_asked=model.file.name,
        recording_asked=tuple(asked.recordings), command=tuple(asked.command),
    )  # fmt: skip
    return Run(record, tuple(_stored(model, setup, fitted, found, step_s)))


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
        stored.append(Stored(TRUTH, "", 0, truth, FITTED, number))
    for one in found:
        for (number, variant), run in sorted(one.runs.items()):
            if variant == BEST:
                stored.append(Stored(one.engine, FITTED, 0, run, FITTED, number))
    return stored
