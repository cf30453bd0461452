"""Events of simulations beside those of a recording: when an impact was, and how long a flight."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from simcompare.alignment.alignment import Alignment, by_events
from simcompare.alignment.matching import match
from simcompare.errors import InputError
from simcompare.inference.segments import Case
from simcompare.inference.simulated import BEST, DOUBLE, HALF, Engine, times
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory
from simcompare.statistics.agreement import e_n
from simcompare.validation.judging import Judged

#: part of the shortest interval within which a simulated and a measured event may be the same
_NEAR = 0.4


def measured_times(case: Case) -> tuple[Array, Array | None]:
    """When the events of a case were, and their standard uncertainties where all are known."""
    found = np.array([event.time_s for event in case.events])
    u = [event.u_s for event in case.events]
    return found, None if None in u else np.array(u, dtype=float)


def aligned(case: Case, scene: Scenario, truth: Trajectory, series: str) -> Alignment:
    """The clock of the recording against that of the scenario, by their events.

    Raises:
        InputError: too few of them belong together.
    """
    found, u = measured_times(case)
    expected = times(scene, truth, series)
    if len(expected) < 2 or len(found) < 2:
        raise InputError(
            f"stream {case.stream}",
            [f"{len(found)} events and {len(expected)} simulated ones; two of both are needed"],
        )
    return by_events(expected, found, u)


def rows(engine: Engine, number: int, judged: Judged, series: str) -> dict[str, Any]:
    """How far the events of an engine are from the measured ones, and every interval.

    Intervals do not depend on where the clocks are zero, so they may be judged where the clocks
    were aligned by the very events.
    """
    case, scene, run = judged.case, judged.scene, engine.runs[number, BEST]
    ours, (theirs, u) = times(scene, run, series), measured_times(case)
    shortest = float(np.min(np.diff(theirs))) if len(theirs) > 1 else math.inf
    near = _NEAR * min(shortest, float(np.min(np.diff(ours))) if len(ours) > 1 else shortest)
    found = match(ours, theirs, near if math.isfinite(near) else 0.1)
    errors = -np.asarray(found.errors_s)
    u_step = _u_step(engine, number, scene, series, ours)
    u_input = _u_input(judged, series)
    # on the log's own clock: a skew that was fitted to the events must not excuse their intervals
    as_recorded = theirs if judged.raw is None else measured_times(judged.raw)[0]
    return {
        "source": engine.name,
        "stream": case.stream,
        "series": series,
        "matched": len(found.pairs),
        "missed": len(found.extra),
        "extra": len(found.missed),
        "bias_s": float(errors.mean()) if len(errors) else None,
        "rmse_s": float(np.sqrt(np.mean(errors**2))) if len(errors) else None,
        "max_abs_s": float(np.max(np.abs(errors))) if len(errors) else None,
        "times_s": ours.tolist(),
        "measured_s": theirs.tolist(),
        "intervals": _intervals(found.pairs, ours, as_recorded, (u, u_step, u_input)),
    }


def _u_step(engine: Engine, number: int, scene: Scenario, series: str, ours: Array) -> float | None:
    """Standard uncertainty of an event's time from the step; ``None`` where it is not known."""
    for variant, factor in ((DOUBLE, 1.0), (HALF, 2.0)):
        other = engine.runs.get((number, variant))
        if other is None:
            continue
        found = times(scene, other, series)
        common = min(len(ours), len(found))
        if common:
            # two steps with safety factor 3 (Roache), half of the band
            return 1.5 * factor * float(np.sqrt(np.mean((ours[:common] - found[:common]) ** 2)))
    return None


def _u_input(judged: Judged, series: str) -> Array | None:
    """Standard uncertainty of every interval from the parameters; ``None`` without a reference."""
    if judged.truth is None:
        return None
    best = np.diff(times(judged.scene, judged.truth, series))
    square = np.zeros(len(best))
    for _, run in judged.shifted:
        moved = np.diff(times(judged.scene, run, series))
        common = min(len(best), len(moved))
        square[:common] += (moved[:common] - best[:common]) ** 2
    return np.sqrt(square)


def _intervals(
    pairs: Sequence[tuple[int, int]],
    ours: Array,
    theirs: Array,
    known: tuple[Array | None, float | None, Array | None],
) -> list[dict[str, Any]]:
    u, u_step, u_input = known
    found: list[dict[str, Any]] = []
    for (i, j), (i_next, j_next) in itertools.pairwise(pairs):
        if i_next != i + 1 or j_next != j + 1:
            continue  # an event between them is missing in one of both
        simulated, measured = float(ours[i_next] - ours[i]), float(theirs[j_next] - theirs[j])
        u_data = None if u is None else math.hypot(u[j], u[j_next])
        u_num = None if u_step is None else math.sqrt(2) * u_step
        u_model = float(u_input[i]) if u_input is not None and i < len(u_input) else None
        parts = (u_data, u_num, u_model)
        whole = math.hypot(*(part or 0.0 for part in parts))
        found.append(
            {
                "number": len(found) + 1,
                "simulated_s": simulated,
                "measured_s": measured,
                "u_data_s": u_data,
                "u_num_s": u_num,
                "u_input_s": u_model,
                "e_n": e_n(simulated, measured, 2 * whole, 0.0) if None not in parts else None,
            }
        )
    return found
