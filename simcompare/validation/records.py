"""What run.json says of a validation, as plain values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from simcompare import units
from simcompare.alignment.alignment import Alignment
from simcompare.inference.estimate import Estimate
from simcompare.inference.plan import Plan
from simcompare.inference.segments import DURATION, noise
from simcompare.inference.sources import Source
from simcompare.model.recording import Provenance
from simcompare.validation.judging import Judged

#: ranges of rows of one repair that run.json keeps; the recording itself has all
_MOST_RANGES = 20


def of_validation(
    source: Source,
    plan: Plan,
    judged: Sequence[Judged],
    fit: Estimate | None,
    rows: Mapping[str, list[dict[str, Any]]],
    agreement: list[dict[str, Any]],
    alignments: Sequence[Alignment | None],
) -> dict[str, Any]:
    """The whole record of a validation.

    Args:
        source: the recording.
        plan: how it was read.
        judged: the cases.
        fit: what was fitted.
        rows: waveforms, values and gaps.
        agreement: of the engines among themselves.
        alignments: of the clock of each case.
    """
    basis = basis_of(plan, source, judged, fit)
    return {
        "recording": source.name,
        "about": dict(source.about) or dict(source.recording.provenance.about),
        "provenance": _provenance(source.recording.provenance),
        "basis": basis,
        "note": plan.note,
        "align": plan.align.model_dump(),
        "compare": {
            probe: {
                "channel": compared.channel,
                "judged": compared.judged,
                "label": judged[0].scene.probes[probe].label,
                "unit": judged[0].scene.probes[probe].unit,
            }
            for probe, compared in plan.compare.items()
        },
        "inputs": {name: driven.channel for name, driven in plan.inputs.items()},
        "parameters": _parameters(plan, judged, fit),
        "fit": None
        if fit is None
        else _fit(
            fit, _fitted_on(plan, source), bool(plan.calibrate and plan.calibrate.chosen_knowing)
        ),
        "cases": [_case(one) for one in judged],
        "events": [asdict(event) for event in source.recording.events[:1000]],
        **rows,
        "agreement": agreement,
        "alignments": [None if one is None else one.to_dict() for one in alignments],
    }


def basis_of(plan: Plan, source: Source, judged: Sequence[Judged], fit: Estimate | None) -> str:
    """What the parameters rest on: "known before", "held out", or "same data"."""
    if fit is None:
        return "known before"
    if plan.calibrate is not None and plan.calibrate.recording is not None:
        from simcompare.inference import sources

        other = sources.digest(plan.calibrate.recording)
        if other != source.recording.provenance.sha256:
            return "held out"
    same = {one.case.stream for one in judged} & {*fit.streams}
    return "same data" if same else "held out"


def _parameters(plan: Plan, judged: Sequence[Judged], fit: Estimate | None) -> list[dict[str, Any]]:
    case = judged[0].case
    best: dict[str, tuple[float, float]] = {}
    if fit is not None:
        pairs = zip(fit.values.tolist(), fit.u.tolist(), strict=True)
        best = dict(zip(fit.names, pairs, strict=True))
    rows = []
    for name, value in judged[0].scene.parameters.items():
        known = case.values.get(name, value)
        if name in plan.start:
            kind, where = "read off", f"recording, channel {plan.start[name].channel}"
        elif name in plan.parameters and known == plan.parameters[name].value:
            kind, where = "known", plan.parameters[name].source
        elif name in case.values and name != DURATION:
            kind, where = "given", "given by the user"
        else:
            kind, where = "scenario", "the scenario's own value"
        fitted = best.get(name)
        rows.append(
            {
                "name": name,
                "unit": units.symbol(units.unit_of(name)),
                "kind": "fitted" if fitted and kind == "scenario" else kind,
                # a start differs from stretch to stretch
                "known": None if kind == "read off" and len(judged) > 1 else float(known),
                "u_known": case.u.get(name) if kind != "scenario" else None,
                "fitted": None if fitted is None else float(fitted[0]),
                "u_fitted": None if fitted is None else float(fitted[1]),
                "source": where,
            }
        )
    return rows


def _fitted_on(plan: Plan, source: Source) -> str:
    other = None if plan.calibrate is None else plan.calibrate.recording
    return other or source.name


def _fit(fit: Estimate, recording: str, chosen_knowing: bool) -> dict[str, Any]:
    u = fit.u
    correlation = fit.covariance / (u[:, None] * u[None, :] + (u[:, None] * u[None, :] == 0))
    return {
        "recording": recording,
        "chosen_knowing": chosen_knowing,
        "names": list(fit.names),
        "streams": list(fit.streams),
        "rms": fit.rms,
        "how": fit.how,
        "correlation": correlation.tolist(),
        "single": {name: values.tolist() for name, values in fit.single.items()},
        "at_bound": list(fit.at_bound),
    }


def _case(one: Judged) -> dict[str, Any]:
    case = one.case
    return {
        "stream": case.stream,
        "start_s": case.start_s,
        "duration_s": case.duration_s,
        "short": case.short,
        "start": {name: value for name, value in case.values.items() if name != DURATION},
        "probes": {
            probe: {
                "samples": len(seen.values),
                "missing": seen.missing,
                "saturated": seen.saturated,
                "u": noise(seen)[0],
                "u_from": noise(seen)[1],
            }
            for probe, seen in case.seen.items()
        },
    }


def _provenance(about: Provenance) -> dict[str, Any]:
    found = asdict(about)
    for repair in found["repairs"]:
        repair["rows"] = repair["rows"][:_MOST_RANGES]
    return found
