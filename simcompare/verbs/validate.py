"""The verb ``validate``: simulations against a recording of a real device, with uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from simcompare import units
from simcompare.alignment.alignment import Alignment, align
from simcompare.compare.comparison import INFO, Score
from simcompare.engine import engines
from simcompare.errors import InputError, UnknownName
from simcompare.inference import plan as plans
from simcompare.inference import sources
from simcompare.inference.estimate import Estimate, estimate
from simcompare.inference.plan import Plan
from simcompare.inference.propagation import moves
from simcompare.inference.reference_model import Model, model_of
from simcompare.inference.segments import Case, as_trajectory, cases_of
from simcompare.inference.simulated import BEST, NOMINAL, Engine, of_probes, simulate
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, CONTACT_LEVELS
from simcompare.model.trajectory import TRUTH, Trajectory
from simcompare.reports.validation import answer
from simcompare.results import run_record, store
from simcompare.results.records.validation import ValidationRecord
from simcompare.results.run import Run, Stored
from simcompare.running.runner import TIME_LIMIT_S, Progress
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.validation import eventful, judging, records
from simcompare.validation.judging import Judged

#: what measured trajectories are stored under
MEASURED = "measured"
#: greatest skew that a clock may have; quartz has 1e-4 at most
MOST_SKEW = 1e-3


def validate(
    scenario: str,
    *,
    recording: str,
    engine: str = "all",
    contact: str = ASSISTED,
    mapping: str | Path | None = None,
    set: Mapping[str, str | float] | None = None,
    streams: Sequence[str] = (),
    step: str | float | None = None,
    strict: bool = False,
    out: str | Path | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Run:
    """Holds simulations against a recording.

    Args:
        scenario: name, folder or file.
        recording: a public data set, the folder of an imported recording, or a log.
        engine: ``"all"`` or names with commas.
        contact: contact level.
        mapping: mapping file, whose ``validate:`` says which channel is which quantity.
        set: parameters that replace what is known before.
        streams: streams that are judged; those of the plan where empty.
        step: time between samples, "1ms" or in seconds.
        strict: refuse a log with any defect.
        out: folder in which the run's own folder is made; nothing is stored where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(engine, done, total)``.

    Returns:
        The run; ``record["validation"]`` holds what was found.

    Raises:
        SimcompareError: faults of the arguments, of a file or of the plan.
    """
    if contact not in CONTACT_LEVELS:
        raise UnknownName("contact level", contact, CONTACT_LEVELS)
    chosen = engines.select(engine)
    file = catalogue.load(scenario)
    source = sources.find(recording, mapping=mapping, strict=strict)
    plan = _plan(file, source)
    given = file.read_settings(set or {})
    step_s = None if step is None else units.to_si(step, "s", "--step")
    if out is not None:
        store.check_writable(Path(out))
    model = model_of(file)
    cases = cases_of(file, plan, source.recording, streams or plan.streams, given)
    fit = _fit(model, plan, source, given, mapping)
    best = None if fit is None else fit.as_dict()
    judged, alignments = _judged(model, plan, cases, fit, step_s)
    found = simulate(
        model, cases, best, chosen, contact=contact, step_s=step_s, time_limit_s=time_limit_s,
        progress=progress,
    )  # fmt: skip
    done = _gather(_Asked(file, source, plan, contact, fit), judged, found, alignments)
    command = _command(scenario, recording, engine, contact, mapping, set, streams, step)
    assert isinstance(done.record, ValidationRecord)
    record = replace(
        done.record, engines_asked=engine, scenario_asked=scenario, recording_asked=str(recording),
        command=(*command, *(["--strict"] if strict else [])),
    )  # fmt: skip
    done = replace(done, record=record)
    if out is None:
        return done
    return store.save(done, Path(out))


def _command(
    scenario: str, recording: str, engine: str, contact: str, mapping: str | Path | None,
    set: Mapping[str, str | float] | None, streams: Sequence[str], step: str | float | None,
) -> list[str]:  # fmt: skip
    words = ["simcompare", "validate", scenario, "--recording", recording, "--engine", engine]
    words += ["--contact", contact] if contact != ASSISTED else []
    words += ["--map", str(mapping)] if mapping is not None else []
    words += [word for name, value in (set or {}).items() for word in ("--set", f"{name}={value}")]
    words += ["--streams", ",".join(streams)] if streams else []
    return words + (["--step", str(step)] if step is not None else [])


def _plan(file: ScenarioFile, source: sources.Source) -> Plan:
    found = plans.choose(source.plans, file.name, source.name)
    faults = plans.faults(found, file.resolve())
    if faults:
        raise InputError(f"{source.name}, validate", faults)
    return found


def _fit(
    model: Model,
    plan: Plan,
    source: sources.Source,
    given: Mapping[str, float],
    mapping: str | Path | None,
) -> Estimate | None:
    """The plan's parameters fitted to its streams; those that the user sets are not fitted."""
    wanted = plan.calibrate
    names = [n for n in wanted.parameters if n not in given] if wanted is not None else []
    if wanted is None or not names:
        return None
    other = source
    own = plan
    if wanted.recording is not None:
        other = sources.find(wanted.recording, mapping=mapping)
        # a log that has no plan of its own is read by that of the recording that is judged
        own = plans.choose(other.plans, plan.scenario, other.name) if other.plans else plan
        faults = plans.faults(own, model.file.resolve())
        if faults:
            raise InputError(f"{other.name}, validate", faults)
    cases = cases_of(model.file, own, other.recording, wanted.streams, given, wanted.most_s)
    probe = tuple(name for name, compared in own.compare.items() if compared.judged)
    fitted = {*names, *wanted.nuisance}
    known = {n: one.u for n, one in own.parameters.items() if one.u > 0 and n not in fitted}
    known = {n: u for n, u in known.items() if n not in given}
    starts = [name for name in own.start if name not in given]
    return estimate(model, cases, probe, names, wanted.nuisance, starts=starts, known=known)


def _judged(
    model: Model,
    plan: Plan,
    cases: Sequence[Case],
    fit: Estimate | None,
    step_s: float | None,
) -> tuple[list[Judged], list[Alignment | None]]:
    found: list[Judged] = []
    alignments: list[Alignment | None] = []
    for case in cases:
        best = {} if fit is None else fit.as_dict()
        scene = model.scenario(case, best, step_s)
        if model.reference is None:
            found.append(Judged(case, None, scene, None, None))
            alignments.append(None)
            continue

        def at(values: Mapping[str, float], case: Case = case) -> Trajectory:
            scene = model.scenario(case, values, step_s)
            return of_probes(scene, model.truth(scene), case.watched)

        truth = at(best)
        shifted = tuple((name, at(values)) for name, values in moves(model.file, case, fit).items())
        shifted += tuple(
            (f"input {name}", at(best, case.with_input_moved(name))) for name in case.u_inputs
        )
        alignment = _aligned(plan, case, scene, truth)
        alignments.append(alignment)
        seen = case if alignment is None else _on_reference(case, alignment)
        raw = None if alignment is None else case
        found.append(Judged(seen, raw, scene, truth, at({}), shifted))
    return found, alignments


def _aligned(plan: Plan, case: Case, scene: Scenario, truth: Trajectory) -> Alignment | None:
    if plan.align.by == "events" and plan.events is not None:
        return _trusted(case, eventful.aligned(case, scene, truth, plan.events.series))
    probe = plan.align.probe
    if probe is None:
        return None
    seen = case.seen[probe]
    return _trusted(case, align(truth.time_s, truth.signals[probe], seen.time_s, seen.values))


def _trusted(case: Case, found: Alignment) -> Alignment:
    """The alignment, where it can be believed.

    Raises:
        InputError: a skew that no clock has, or fewer than half of the events matched.
    """
    events = len(found.matched) + len(found.extra)
    if abs(found.skew) > MOST_SKEW or (events and len(found.matched) < 0.5 * events):
        raise InputError(
            f"stream {case.stream}, align",
            [
                f"the clocks cannot be aligned: {found.text} The parameters that are known may be"
                " too far off; mend them with --set, or calibrate them"
            ],
        )
    return found


def _on_reference(case: Case, alignment: Alignment) -> Case:
    seen = {
        probe: replace(one, time_s=alignment.to_reference(one.time_s))
        for probe, one in case.seen.items()
    }
    events = tuple(
        replace(event, time_s=float(alignment.to_reference(np.array([event.time_s]))[0]))
        for event in case.events
    )
    return replace(case, seen=seen, events=events)


@dataclass(frozen=True)
class _Asked:
    file: ScenarioFile
    source: sources.Source
    plan: Plan
    contact: str
    fit: Estimate | None


def _gather(
    asked: _Asked,
    judged: Sequence[Judged],
    found: Sequence[Engine],
    alignments: Sequence[Alignment | None],
) -> Run:
    rows: dict[str, list[dict[str, Any]]] = {
        "waveforms": [], "values": [], "gaps": [], "timings": [],
        "spread": [row for k, one in enumerate(judged) for row in judging.spread(found, k, one)],
    }  # fmt: skip
    happened = asked.plan.events
    fitted = asked.fit is not None
    for engine in found:
        for number, one in enumerate(judged):
            if engine.complete(number):
                rows["waveforms"] += judging.waveforms(engine, number, one, asked.plan, fitted)
                rows["values"] += judging.values(engine, number, one)
                rows["gaps"] += judging.gaps(engine, number, one, asked.plan)
                if happened is not None:
                    rows["timings"].append(eventful.rows(engine, number, one, happened.series))
    sources_ = [run_record.of_source(e.name, asked.contact, e.outcomes) for e in found]
    scores = [_score(row, asked.contact) for row in rows["values"]]
    scenes = [one.scene for one in judged]
    truth = TRUTH if judged[0].truth is not None else None
    validated = records.of_validation(
        asked.source, asked.plan, judged, asked.fit, rows, judging.agreement(rows["values"]),
        alignments,
    )  # fmt: skip
    record = run_record.of_run(
        ValidationRecord, asked.file, scenes[:1], truth, sources_, scores,
        validation=answer.with_words(validated),
    )  # fmt: skip
    return Run(record, tuple(_stored(judged, found)))


def _score(row: Mapping[str, Any], contact: str) -> Score:
    return Score(
        row["source"], contact, row["measure"], row["probe"], None, row["simulated"],
        None, row["u_simulated"], row["unit"], 1, row["measured"],
        2 * row["u_val"] if row["e_n"] is not None else None, INFO,
    )  # fmt: skip


def _stored(judged: Sequence[Judged], found: Sequence[Engine]) -> list[Stored]:
    """Measured, reference and engines; the repeat is the number of the case."""
    stored = []
    for number, one in enumerate(judged):
        if one.case.seen:
            stored.append(Stored(MEASURED, "", number, as_trajectory(one.case)))
        if one.truth is not None:
            bands = {f"u({probe})": one.u_input(probe) for probe in one.case.seen}
            signals = {**one.truth.signals, **{k: v for k, v in bands.items() if v is not None}}
            stored.append(Stored(TRUTH, BEST, number, Trajectory(TRUTH, one.truth.time_s, signals)))
        if one.nominal is not None:
            stored.append(Stored(TRUTH, NOMINAL, number, one.nominal))
    for engine in found:
        for (number, variant), run in engine.runs.items():
            if variant in (BEST, NOMINAL):
                stored.append(Stored(engine.name, variant, number, run))
    return stored
