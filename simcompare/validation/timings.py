"""Events of simulations held against those of a recording, such as impacts."""

from __future__ import annotations

import numpy as np

from simcompare.comparison.events import EventUncertainty, compare_events, event_times
from simcompare.inference.evaluated import Evaluated, times_of_events
from simcompare.inference.simulated import BEST, DOUBLE, HALF, Engine
from simcompare.model.trajectory import Array
from simcompare.results.records.validation import TimingRecord
from simcompare.statistics.agreement import rms


def timing(engine: Engine, number: int, one: Evaluated, series: str) -> TimingRecord:
    """How far the events of an engine are from the measured ones, and every interval.

    Args:
        engine: what it gave.
        number: of the segment.
        one: the segment.
        series: what the scenario calls the times of its events.
    """
    simulated_s = event_times(one.scene, engine.runs[number, BEST], series)
    measured_s, u_data = times_of_events(one.segment)
    recorded_s = times_of_events(one.recorded or one.segment)[0]
    u_num = _u_num(engine, number, one, series, simulated_s)
    u = EventUncertainty(u_data, u_num, _u_input(one, series))
    comparison = compare_events(simulated_s, measured_s, recorded_s, u)
    return TimingRecord(
        source=engine.name, stream=one.segment.stream, series=series, **vars(comparison)
    )


def _u_num(
    engine: Engine, number: int, one: Evaluated, series: str, simulated_s: Array
) -> float | None:
    """Standard uncertainty of an event's time from the step [s]; ``None`` where it is unknown."""
    for variant, factor in ((DOUBLE, 1.0), (HALF, 2.0)):
        other = engine.runs.get((number, variant))
        if other is None:
            continue
        other_s = event_times(one.scene, other, series)
        common = min(len(simulated_s), len(other_s))
        if common:
            # two steps with safety factor 3 (Roache), half of the band
            return 1.5 * factor * rms(simulated_s[:common] - other_s[:common])
    return None


def _u_input(one: Evaluated, series: str) -> Array | None:
    """Standard uncertainty of every interval from the parameters; ``None`` without a reference."""
    if one.truth is None:
        return None
    best = np.diff(event_times(one.scene, one.truth, series))
    square = np.zeros(len(best))
    for _, run in one.shifted:
        moved = np.diff(event_times(one.scene, run, series))
        common = min(len(best), len(moved))
        square[:common] += (moved[:common] - best[:common]) ** 2
    return np.sqrt(square)
