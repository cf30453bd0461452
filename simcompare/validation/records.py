"""The record of a validation, from its segments and their rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from simcompare import units
from simcompare.inference import sources
from simcompare.inference.estimate import Estimate
from simcompare.inference.evaluated import Evaluated
from simcompare.inference.plan import Plan
from simcompare.inference.segments import DURATION, noise
from simcompare.inference.simulated import Engine
from simcompare.inference.sources import Source
from simcompare.model.recording import Provenance
from simcompare.results.records.validation import (
    HELD_OUT,
    KNOWN,
    SAME,
    CalibrationRecord,
    ComparedProbe,
    ParameterRecord,
    ProbeRecord,
    SegmentRecord,
    Validation,
)
from simcompare.statistics.suspicions import Suspicion
from simcompare.validation.beginnings import apart
from simcompare.validation.signals import gaps, spread, waveforms
from simcompare.validation.timings import timing
from simcompare.validation.values import agreement, values

#: events of the recording, and ranges of rows of one repair, that run.json keeps
_MAX_EVENTS, _MAX_RANGES = 1000, 20


@dataclass(frozen=True)
class Compared:
    """Everything that was compared.

    Attributes:
        source: the recording.
        plan: how it was read.
        fit: what was fitted, ``None`` where nothing was.
        segments: of the recording.
        engines: what they gave.
        suspected: a mistake in what is said of the recording, where one explains that it misfits.
    """

    source: Source
    plan: Plan
    fit: Estimate | None
    segments: Sequence[Evaluated]
    engines: Sequence[Engine]
    suspected: Suspicion | None = None


def of_validation(done: Compared) -> Validation:
    """The whole record of a validation, without its words."""
    source, plan, segments, fit = done.source, done.plan, done.segments, done.fit
    pairs = [
        (engine, number, one)
        for engine in done.engines
        for number, one in enumerate(segments)
        if engine.complete(number)
    ]
    is_fitted = fit is not None
    rows = tuple(row for pair in pairs for row in values(*pair))
    series = None if plan.events is None else plan.events.series
    return Validation(
        recording=source.name,
        about=dict(source.about) or dict(source.recording.provenance.about),
        provenance=_provenance(source.recording.provenance),
        basis=basis_of(done),
        note=plan.note,
        align=plan.align,
        compare=_compared(plan, segments[0]),
        inputs={name: driven.channel for name, driven in plan.inputs.items()},
        parameters=tuple(_parameters(done)),
        fit=None if fit is None else _fit(fit, plan, source),
        cases=tuple(_segment(one) for one in segments),
        events=source.recording.events[:_MAX_EVENTS],
        waveforms=tuple(row for p in pairs for row in waveforms(*p, plan, fitted=is_fitted)),
        values=rows,
        gaps=tuple(row for pair in pairs for row in gaps(*pair, plan)),
        timings=() if series is None else tuple(timing(*pair, series) for pair in pairs),
        spread=tuple(
            row for number, one in enumerate(segments) for row in spread(done.engines, number, one)
        ),
        agreement=tuple(agreement(rows)),
        alignments=tuple(one.alignment for one in segments),
        apart=tuple(row for one in segments for row in apart(plan, one, fit)),
        suspected=done.suspected,
    )


def basis_of(done: Compared) -> str:
    """What the parameters rest on: "known before", "held out", or "same data"."""
    if done.fit is None:
        return KNOWN
    calibrate = done.plan.calibrate
    if calibrate is not None and calibrate.recording is not None:
        other = sources.digest(calibrate.recording)
        if other != done.source.recording.provenance.sha256:
            return HELD_OUT
    same = {one.segment.stream for one in done.segments} & {*done.fit.streams}
    return SAME if same else HELD_OUT


def _compared(plan: Plan, one: Evaluated) -> dict[str, ComparedProbe]:
    compared_probes = {}
    for name, compared in plan.compare.items():
        probe = one.scene.probes[name]
        compared_probes[name] = ComparedProbe(
            compared.channel, probe.label, probe.unit, compared.judged
        )
    return compared_probes


def _parameters(done: Compared) -> list[ParameterRecord]:
    plan, segment = done.plan, done.segments[0].segment
    fitted = {} if done.fit is None else done.fit.as_dict()
    u_fitted = {} if done.fit is None else dict(zip(done.fit.names, done.fit.u, strict=True))
    rows = []
    for name, value in done.segments[0].scene.parameters.items():
        known = segment.values.get(name, value)
        if name in plan.start:
            kind, where = "read off", f"recording, channel {plan.start[name].channel}"
        elif name in plan.parameters and known == plan.parameters[name].value:
            kind, where = "known", plan.parameters[name].source
        elif name in segment.values and name != DURATION:
            kind, where = "given", "given by the user"
        else:
            kind, where = "scenario", "the scenario's own value"
        several = kind == "read off" and len(done.segments) > 1
        rows.append(
            ParameterRecord(
                name,
                units.symbol(units.unit_of(name)),
                "fitted" if name in fitted and kind == "scenario" else kind,
                None if several else float(known),
                segment.u.get(name) if kind != "scenario" else None,
                fitted.get(name),
                float(u_fitted[name]) if name in fitted else None,
                where,
            )
        )
    return rows


def _fit(fit: Estimate, plan: Plan, source: Source) -> CalibrationRecord:
    size = fit.u[:, None] * fit.u[None, :]
    correlation = fit.covariance / (size + (size == 0))
    calibrate = plan.calibrate
    return CalibrationRecord(
        recording=(calibrate and calibrate.recording) or source.name,
        chosen_knowing=bool(calibrate and calibrate.chosen_knowing),
        names=fit.names,
        streams=fit.streams,
        rms=fit.rms,
        how=fit.how,
        correlation=tuple(tuple(row) for row in correlation.tolist()),
        single={name: tuple(values.tolist()) for name, values in fit.single.items()},
        at_bound=fit.at_bound,
    )


def _segment(one: Evaluated) -> SegmentRecord:
    segment = one.segment
    return SegmentRecord(
        segment.stream,
        segment.start_s,
        segment.duration_s,
        segment.short,
        {name: value for name, value in segment.values.items() if name != DURATION},
        {
            probe: ProbeRecord(
                len(measured.values), measured.missing, measured.saturated, *noise(measured)
            )
            for probe, measured in segment.observed.items()
        },
    )


def _provenance(about: Provenance) -> Provenance:
    repairs = tuple(replace(one, rows=one.rows[:_MAX_RANGES]) for one in about.repairs)
    return replace(about, repairs=repairs)
