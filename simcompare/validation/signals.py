"""Simulated signals held against measured ones: how far they are off, and what that is made of."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from simcompare.comparison.events import event_times
from simcompare.comparison.waveform import waveform
from simcompare.inference.evaluated import Evaluated
from simcompare.inference.plan import Plan
from simcompare.inference.segments import noise
from simcompare.inference.simulated import BEST, DOUBLE, NOMINAL, Engine
from simcompare.model.resampling import interpolated
from simcompare.model.trajectory import Array, Trajectory
from simcompare.results.records.validation import (
    FITTED,
    KNOWN,
    GapRecord,
    SpreadRecord,
    WaveformRecord,
)
from simcompare.statistics.agreement import coverage, rms
from simcompare.statistics.gap import split


def waveforms(
    engine: Engine, number: int, one: Evaluated, plan: Plan, *, fitted: bool
) -> Iterator[WaveformRecord]:
    """How far an engine is from each measured signal, with and without fit and alignment.

    Args:
        engine: what it gave.
        number: of the segment.
        one: the segment.
        plan: which quantities are judged.
        fitted: whether any parameter was fitted.
    """
    variants = [(NOMINAL, KNOWN)] + ([(BEST, FITTED)] if fitted else [])
    clocks = [(one.segment, one.recorded is not None)]
    clocks += [] if one.recorded is None else [(one.recorded, False)]
    for probe in one.segment.observed:
        for variant, words in variants:
            run = engine.runs[number, variant]
            for segment, is_aligned in clocks:
                measured = segment.observed[probe]
                simulated = _at(one, plan, run, probe, measured.time_s)
                deviation = waveform(measured.values, simulated, u=noise(measured)[0] or None)
                yield WaveformRecord(
                    source=engine.name,
                    stream=one.segment.stream,
                    probe=probe,
                    unit=one.scene.probes[probe].unit,
                    judged=plan.compare[probe].judged,
                    parameters=words,
                    aligned=is_aligned,
                    **vars(deviation),
                )


def gaps(engine: Engine, number: int, one: Evaluated, plan: Plan) -> Iterator[GapRecord]:
    """What the gap between an engine as known before and the measurement is made of."""
    for probe, measured in one.segment.observed.items():
        if not plan.compare[probe].judged:
            continue

        def at(run: Trajectory, probe: str = probe, time_s: Array = measured.time_s) -> Array:
            return _at(one, plan, run, probe, time_s)

        best, nominal = (at(engine.runs[number, variant]) for variant in (BEST, NOMINAL))
        # without a reference the numerical error is what the next longer step changes
        exact = engine.runs.get((number, DOUBLE)) if one.truth is None else one.truth
        u_num = 0.0 if exact is None else rms(best - at(exact))
        u_input = _u_input(one, probe, measured.time_s)
        gap = split(measured.values, nominal, best, measured.u, u_num)
        covered = None
        if u_input is not None:
            u = np.hypot(u_input, math.hypot(gap.noise, u_num))
            covered = coverage(best - measured.values, u)
        yield GapRecord(
            source=engine.name,
            stream=one.segment.stream,
            probe=probe,
            unit=one.scene.probes[probe].unit,
            input=None if u_input is None else rms(u_input),
            covered=covered,
            **vars(gap),
        )


def spread(engines: Sequence[Engine], number: int, one: Evaluated) -> Iterator[SpreadRecord]:
    """How far the engines are from each other: from their mean, over the measured samples."""
    runs = {e.name: e.runs[number, BEST] for e in engines if (number, BEST) in e.runs}
    if len(runs) < 2:
        return
    for probe, measured in one.segment.observed.items():
        table = np.stack(
            [interpolated(r.time_s, r.signals[probe], measured.time_s) for r in runs.values()]
        )
        size = rms(table - table.mean(axis=0))
        yield SpreadRecord(one.segment.stream, probe, tuple(runs), size)


def _at(one: Evaluated, plan: Plan, run: Trajectory, probe: str, time_s: Array) -> Array:
    """A simulated signal at the times of a measurement; NaN outside, and next to impacts."""
    # nothing is smooth at an impact; the plan names them
    jumps_s = np.zeros(0)
    if plan.events is not None:
        jumps_s = event_times(one.scene, run, plan.events.series)
    return interpolated(run.time_s, run.signals[probe], time_s, events_s=jumps_s)


def _u_input(one: Evaluated, probe: str, time_s: Array) -> Array | None:
    """Standard uncertainty from the parameters at the times of a measurement."""
    u = one.u_input(probe)
    if one.truth is None or u is None:
        return None
    return interpolated(one.truth.time_s, u, time_s)
