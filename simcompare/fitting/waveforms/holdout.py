"""Stretches that were not fitted, predicted by the reference and by every engine."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from simcompare.fitting.waveforms.engines import EngineWaves
from simcompare.fitting.waveforms.reference import Fitted
from simcompare.fitting.waveforms.setup import Setup
from simcompare.inference.compared_values import compared_values
from simcompare.inference.evaluated import Evaluated
from simcompare.inference.propagation import moves
from simcompare.inference.reference_model import Model
from simcompare.inference.segments import Segment
from simcompare.inference.simulated import BEST, Engine, of_probes
from simcompare.model.resampling import interpolated
from simcompare.model.trajectory import TRUTH, Trajectory

#: what of a row of a validation is told here
_TOLD = ("measure", "probe", "unit", "simulated", "measured", "u_num", "u_input", "u_data", "u_val",
         "e_n")  # fmt: skip


def predict(
    model: Model, setup: Setup, fitted: Fitted, engines: Sequence[EngineWaves], step_s: float | None
) -> dict[str, Any]:
    """How well what was fitted predicts stretches that it has not seen.

    Every stretch starts as it was read off itself; everything else is as fitted. The values of the
    scenario's measures are held against the measured ones by E_n (k = 2).

    Returns:
        Plain values: a row for each stretch under ``streams``, in it ``engines`` by name.
    """
    if not setup.held:
        return {
            "streams": [], "drops": [], "text": "No stream was held out, so nothing was validated."
        }  # fmt: skip
    rows = []
    for number, case in enumerate(setup.held, start=len(setup.fitted)):
        judged = _judged(model, fitted, case, step_s)
        assert judged.truth is not None
        closed = _row(judged, number, Engine(TRUTH, (), {(number, BEST): judged.truth}))
        found = {
            one.engine: _row(judged, number, Engine(one.engine, one.outcomes, one.runs))
            for one in engines
            if (number, BEST) in one.runs
        }
        rows.append({"stream": case.stream, "duration_s": case.duration_s, **closed,
                     "engines": found})  # fmt: skip
    return {"streams": rows, "drops": [], "text": _text(model, setup, rows)}


def _judged(model: Model, fitted: Fitted, case: Segment, step_s: float | None) -> Evaluated:
    best = fitted.estimate.as_dict()
    scene = model.scenario(case, best, step_s)

    def at(values: Mapping[str, float]) -> Trajectory:
        moved = model.scenario(case, values, step_s)
        return of_probes(moved, model.truth(moved), case.watched)

    moved = moves(model.file, case, fitted.estimate)
    shifted = tuple((what, at(values)) for what, values in moved.items())
    return Evaluated(case, scene, at(best), None, shifted)


def _row(judged: Evaluated, number: int, engine: Engine) -> dict[str, Any]:
    run = engine.runs[number, BEST]
    rms = {probe: rms_of(judged.segment, run, probe) for probe in judged.segment.observed}
    values = []
    for row in compared_values(engine, number, judged):
        told = {key: getattr(row, key) for key in _TOLD}
        # a reference has no step
        u_val = math.hypot(row.u_input or 0.0, row.u_data or 0.0)
        if engine.name == TRUTH and u_val > 0 and row.u_input is not None:
            told |= {"u_num": 0.0, "u_val": u_val, "e_n": row.error / (2 * u_val)}
        values.append(told)
    return {"rms": rms, "values": values}


def rms_of(case: Segment, run: Trajectory, probe: str) -> float:
    """Root mean square of simulated less measured, in the unit of the probe."""
    seen = case.observed[probe]
    left = interpolated(run.time_s, run.signals[probe], seen.time_s) - seen.values
    return float(np.sqrt(np.nanmean(left**2)))


def _text(model: Model, setup: Setup, rows: Sequence[Mapping[str, Any]]) -> str:
    from simcompare import units
    from simcompare.notation import number

    found = [own for row in rows for own in row["engines"].values()]
    if not found:
        return "Streams were held out, but no engine could be run for them."
    judged = [v["e_n"] for own in found for v in own["values"] if v["e_n"] is not None]
    good = sum(abs(value) <= 1 for value in judged)
    probe = setup.probes[0]
    sizes = [own["rms"][probe] for own in found]
    unit = units.symbol(model.file.resolve().probes[probe].unit)
    said = (
        f"{good} of {len(judged)} values that engines predict for streams that were held out agree"
        " with the measured ones within their uncertainty (|E_n| ≤ 1, k = 2)"
    )
    return (
        f"{said}; {probe} is {number(float(f'{min(sizes):.3g}'))} to"
        f" {number(float(f'{max(sizes):.3g}'))} {unit} off (root mean square)."
    )
