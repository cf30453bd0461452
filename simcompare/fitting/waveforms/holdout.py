"""Segments that were not fitted, predicted by the reference and by every engine."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace

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
from simcompare.results.records.fit_waveforms import (
    HeldOutSegment,
    JudgedValue,
    Predicted,
    WaveHoldout,
)
from simcompare.statistics.agreement import COVERAGE_FACTOR, e_n, rms


def predict(
    model: Model, setup: Setup, fitted: Fitted, engines: Sequence[EngineWaves], step_s: float | None
) -> WaveHoldout:
    """How well what was fitted predicts segments that it has not seen.

    Every segment starts as it was read off itself; everything else is as fitted. The values of the
    scenario's measures are held against the measured ones by E_n (k = 2).
    """
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
        rows.append(
            HeldOutSegment(stream=case.stream, duration_s=case.duration_s, engines=found,
                           **vars(closed))
        )  # fmt: skip
    return WaveHoldout(tuple(rows))


def _judged(model: Model, fitted: Fitted, case: Segment, step_s: float | None) -> Evaluated:
    best = fitted.estimate.as_dict()
    scene = model.scenario(case, best, step_s)

    def at(values: Mapping[str, float]) -> Trajectory:
        moved = model.scenario(case, values, step_s)
        return of_probes(moved, model.truth(moved), case.watched)

    moved = moves(model.file, case, fitted.estimate)
    shifted = tuple((what, at(values)) for what, values in moved.items())
    return Evaluated(case, scene, at(best), None, shifted)


def _row(judged: Evaluated, number: int, engine: Engine) -> Predicted:
    run = engine.runs[number, BEST]
    found = {probe: rms_of(judged.segment, run, probe) for probe in judged.segment.observed}
    values = []
    for row in compared_values(engine, number, judged):
        one = JudgedValue(**{field.name: getattr(row, field.name) for field in fields(JudgedValue)})
        # a reference has no step
        u_val = math.hypot(one.u_input or 0.0, one.u_data or 0.0)
        if engine.name == TRUTH and u_val > 0 and one.u_input is not None:
            number_of_error = e_n(row.error, 0.0, COVERAGE_FACTOR * u_val, 0.0)
            one = replace(one, u_num=0.0, u_val=u_val, e_n=number_of_error)
        values.append(one)
    return Predicted(rms=found, values=tuple(values))


def rms_of(case: Segment, run: Trajectory, probe: str) -> float:
    """Root mean square of simulated less measured, in the unit of the probe."""
    observed = case.observed[probe]
    residual = interpolated(run.time_s, run.signals[probe], observed.time_s) - observed.values
    return rms(residual)
