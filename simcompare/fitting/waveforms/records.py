"""What fit.json says of a fit by waveform; its sentences are written by its report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from simcompare import units
from simcompare.comparison.values import ValuePair, overlap, resampled, value_pairs
from simcompare.engine.assist import ALL
from simcompare.fitting.waveforms.engines import EngineWaves
from simcompare.fitting.waveforms.holdout import rms_of
from simcompare.fitting.waveforms.reference import Fitted
from simcompare.fitting.waveforms.setup import Setup
from simcompare.inference.reference_model import Model
from simcompare.inference.segments import DURATION, Segment, as_trajectory, noise
from simcompare.inference.simulated import BEST, HALF
from simcompare.model.settings import ASSISTED
from simcompare.model.trajectory import Array, Trajectory
from simcompare.results.records.fit_parts import Known
from simcompare.results.records.fit_waveforms import (
    EffectiveSignal,
    FitSegment,
    FittedReference,
    MeasuredProbe,
    SourcePrediction,
    WaveEngine,
    WaveformFit,
    WaveHoldout,
    WaveParameter,
    WaveValid,
)
from simcompare.statistics.identifiability import Identifiability, identifiability


def of_fit(
    model: Model,
    setup: Setup,
    fitted: Fitted,
    engines: Sequence[EngineWaves],
    predicted: WaveHoldout,
    given: Mapping[str, float],
    step_s: float,
) -> WaveformFit:
    """The whole record of a fit, without its sentences.

    Args:
        model: the scenario.
        setup: what was fitted and held out.
        fitted: the reference as fitted.
        engines: what each engine must be given.
        predicted: the segments that were held out.
        given: further parameters of the scenario.
        step_s: time between samples of the engines.
    """
    known = known_of(setup, fitted)
    starts = fitted.solution.starts
    return WaveformFit(
        contact=ASSISTED, assist=ALL, scenario=model.file.name, settings=dict(given),
        probes=setup.probes,
        measured=tuple(_segment(c, s) for c, s in zip(setup.fitted, starts, strict=True)),
        chosen=setup.chosen, held_out=tuple(_segment(case, {}) for case in setup.held),
        closed_form=_closed(model, setup, fitted), identifiability=Known(**vars(known)),
        sources=tuple(
            _source(model, setup, fitted, one, predicted, not known.is_weak) for one in engines
        ),
        holdout=predicted, valid=_valid(setup, step_s),
    )  # fmt: skip


def known_of(setup: Setup, fitted: Fitted) -> Identifiability:
    """What the recording tells of the unknowns, nuisance ones included."""
    # one standard deviation of the data is what is left over, correlated or not
    spread = np.concatenate(
        [
            np.full(len(residuals), float(np.sqrt(np.mean(residuals**2))) or 1.0)
            for residuals in fitted.solution.residuals
        ]
    )
    return identifiability(setup.every, fitted.solution.jacobian / spread[:, None])


def _closed(model: Model, setup: Setup, fitted: Fitted) -> FittedReference:
    own = fitted.estimate
    rest = fitted.solution.values[len(own.names) :].tolist()
    return FittedReference(
        parameters=parameters(model, fitted, own.values, None), names=own.names,
        correlation=_correlation(fitted.covariance), rms=own.rms, how=own.how,
        streams=own.streams,
        single={name: tuple(values.tolist()) for name, values in own.single.items()},
        at_bound=own.at_bound, nuisance=dict(zip(setup.nuisance, rest, strict=True)),
        known={
            name: dict(zip(own.names, np.abs(move).tolist(), strict=True))
            for name, move in own.follows.items()
        },
    )  # fmt: skip


def coverage_factor(fitted: Fitted) -> float:
    """For 95 %: Student's t where few streams tell how much they scatter, else 1.96."""
    from scipy.stats import t

    streams = len(fitted.estimate.streams)
    return float(t.ppf(0.975, streams - 1)) if streams >= 3 else 1.96


def parameters(
    model: Model, fitted: Fitted, values: Array, u_num: Array | None
) -> dict[str, WaveParameter]:
    """Values with their uncertainty and its parts; ``u_num`` is that of an engine's step."""
    k, factor = len(fitted.estimate.names), coverage_factor(fitted)
    numerical = np.zeros(k) if u_num is None else u_num[:k]
    u = np.sqrt(np.diag(fitted.covariance) + np.nan_to_num(numerical) ** 2)
    found = {}
    for i, name in enumerate(fitted.estimate.names):
        bounds, value, half = model.file.parameters[name], float(values[i]), factor * float(u[i])
        # what a parameter cannot be is in no interval of it
        low, high = max(value - half, bounds.min), min(value + half, bounds.max)
        found[name] = WaveParameter(
            value=value, u=float(u[i]), low=low, high=high, interval95=(low, high),
            unit=units.unit_of(name), u_data=float(fitted.estimate.u[i]),
            u_known=float(fitted.u_known[i]), u_num=float(numerical[i]),
        )  # fmt: skip
    return found


def _correlation(covariance: Array) -> tuple[tuple[float, ...], ...]:
    u = np.sqrt(np.diag(covariance))
    product = np.outer(u, u)
    rows = covariance / np.where(product > 0, product, 1.0)
    return tuple(tuple(row.tolist()) for row in rows)


def _source(
    model: Model,
    setup: Setup,
    fitted: Fitted,
    one: EngineWaves,
    predicted: WaveHoldout,
    identifiable: bool,
) -> WaveEngine:
    """What the record says of one engine."""
    found: dict[str, Any] = {}
    if one.status == "ok":
        k = len(setup.names)
        numerical = np.diag(np.nan_to_num(one.u_num[:k]) ** 2)
        u = np.hypot(np.sqrt(np.diag(fitted.covariance)), np.sqrt(np.diag(numerical)))
        effective = {
            name: EffectiveSignal(float(value), float(own), units.unit_of(name))
            for name, value, own in zip(setup.names, one.effective, u, strict=False)
        }
        found = {
            "parameters": parameters(model, fitted, one.x, one.u_num),
            "correlation": _correlation(fitted.covariance + numerical),
            "effective": {**effective, **_shown(model, setup, one)},
            "change": dict(zip(setup.every, one.change.tolist(), strict=True)),
            "rms": {
                case.stream: {p: rms_of(case, one.runs[i, BEST], p) for p in setup.probes}
                for i, case in enumerate(setup.fitted)
            },
        }
    return WaveEngine(
        name=one.engine, version=one.version, contact=ASSISTED, status=one.status,
        reason=one.reason, simulations=one.simulations, wall_s=one.wall_s,
        identifiable=identifiable,
        holdout=tuple(
            SourcePrediction(source=row.stream, **vars(row.engines[one.engine]))
            for row in predicted.streams if one.engine in row.engines
        ),
        **found,
    )  # fmt: skip


def _shown(model: Model, setup: Setup, one: EngineWaves) -> dict[str, EffectiveSignal]:
    """Values of the scenario's measures in the fitted segments, mean over them."""
    rows: dict[str, list[tuple[float, float, float]]] = {}
    unit_of: dict[str, str] = {}
    for i, case in enumerate(setup.fitted):
        found = _values(model, case, one.runs[i, BEST])
        finer = _values(model, case, one.runs[i, HALF]) if (i, HALF) in one.runs else {}
        for name, both in found.items():
            change = abs(finer[name].simulated - both.simulated) if name in finer else np.nan
            rows.setdefault(name, []).append((both.simulated, both.measured, change))
            unit_of[name] = both.unit
    means = {name: np.mean(own, axis=0).tolist() for name, own in rows.items()}
    return {
        name: EffectiveSignal(simulated, change, unit_of[name], measured)
        for name, (simulated, measured, change) in means.items()
    }


def _values(model: Model, case: Segment, run: Trajectory) -> Mapping[str, ValuePair]:
    measured = overlap(as_trajectory(case), run)
    return value_pairs(
        model.scenario(case), resampled(run, measured), measured, tuple(measured.signals)
    )


def _segment(case: Segment, start: Mapping[str, float]) -> FitSegment:
    """What the record says of one segment, and of the start that the fit found."""
    return FitSegment(
        stream=case.stream, start_s=case.start_s, duration_s=case.duration_s,
        start={name: value for name, value in case.values.items() if name != DURATION},
        probes={
            probe: MeasuredProbe(len(seen.values), seen.missing, *noise(seen))
            for probe, seen in case.observed.items()
        },
        fitted_start=dict(start),
    )  # fmt: skip


def _valid(setup: Setup, step_s: float) -> WaveValid:
    """Within what the fit was made: step, length, and range of every compared quantity."""
    ranges = {
        probe: (
            float(min(case.observed[probe].values.min() for case in setup.fitted)),
            float(max(case.observed[probe].values.max() for case in setup.fitted)),
        )
        for probe in setup.probes
    }
    return WaveValid(step_s, max(case.duration_s for case in setup.fitted), ranges)
