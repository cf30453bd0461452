"""Events of a simulation held against measured ones: when they were, and how long between them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare import measures
from simcompare.alignment.matching import match
from simcompare.comparison.values import observing
from simcompare.errors import UnknownName
from simcompare.model.scenario import Measure, Scenario
from simcompare.model.trajectory import Array, Trajectory
from simcompare.statistics.agreement import rms, vv20

#: part of the shortest interval within which a simulated and a measured event may be the same
_NEAR = 0.4
#: and how near they must be where there is no interval [s]
_NEAR_S = 0.1


@dataclass(frozen=True)
class Interval:
    """Time between two neighbouring events that both have.

    Attributes:
        number: of the interval, first is 1.
        simulated_s: in the simulation [s].
        measured_s: in the measurement [s].
        u_data_s: standard uncertainty of the measured one [s]; ``None`` where unknown.
        u_num_s: standard uncertainty from the step [s].
        u_input_s: standard uncertainty from the parameters [s].
        e_n: E_n number; ``None`` where a part of the uncertainty is unknown.
    """

    number: int
    simulated_s: float
    measured_s: float
    u_data_s: float | None
    u_num_s: float | None
    u_input_s: float | None
    e_n: float | None


@dataclass(frozen=True)
class EventComparison:
    """Events of a simulation beside measured ones; errors are simulated minus measured.

    Attributes:
        matched: number of events that both have.
        missed: measured and not simulated.
        extra: simulated and not measured.
        bias_s: mean error of those that both have [s]; ``None`` without any.
        rmse_s: root mean square of the errors [s].
        max_abs_s: largest error [s].
        times_s: all simulated times [s].
        measured_s: all measured times [s].
        intervals: between neighbouring events that both have.
    """

    matched: int
    missed: int
    extra: int
    bias_s: float | None
    rmse_s: float | None
    max_abs_s: float | None
    times_s: tuple[float, ...]
    measured_s: tuple[float, ...]
    intervals: tuple[Interval, ...]


@dataclass(frozen=True)
class EventUncertainty:
    """Standard uncertainties of events; ``None`` where one is unknown.

    Attributes:
        data_s: of every measured time (m,) [s].
        num_s: of a simulated time, from the step [s].
        input_s: of every simulated interval, from the parameters [s].
    """

    data_s: Array | None
    num_s: float | None
    input_s: Array | None

    def of_interval(self, i: int, j: int) -> tuple[float | None, float | None, float | None]:
        """Of the interval after simulated event i and measured event j: step, parameters, data."""
        u_num = None if self.num_s is None else math.sqrt(2) * self.num_s
        known = self.input_s is not None and i < len(self.input_s)
        u_input = float(self.input_s[i]) if self.input_s is not None and known else None
        u_data = None if self.data_s is None else math.hypot(self.data_s[j], self.data_s[j + 1])
        return u_num, u_input, u_data


def compare_events(
    simulated_s: Array, measured_s: Array, recorded_s: Array, u: EventUncertainty
) -> EventComparison:
    """How far simulated events are from measured ones, and every interval.

    Intervals do not depend on where the clocks are zero, so they may be judged where the clocks
    were aligned by the very events.

    Args:
        simulated_s: times of the simulated events (n,) [s].
        measured_s: times of the measured events on the same clock (m,) [s].
        recorded_s: the same on the log's own clock: a skew that was fitted to the events must not
            excuse their intervals (m,) [s].
        u: what is known of their uncertainty.
    """
    shortest = min(_shortest(simulated_s), _shortest(measured_s))
    near = _NEAR * shortest if math.isfinite(shortest) else _NEAR_S
    matching = match(simulated_s, measured_s, near)
    errors = -np.asarray(matching.errors_s)
    some = len(errors) > 0
    return EventComparison(
        matched=len(matching.pairs),
        missed=len(matching.extra),
        extra=len(matching.missed),
        bias_s=float(errors.mean()) if some else None,
        rmse_s=rms(errors) if some else None,
        max_abs_s=float(np.max(np.abs(errors))) if some else None,
        times_s=tuple(simulated_s.tolist()),
        measured_s=tuple(measured_s.tolist()),
        intervals=tuple(_intervals(matching.pairs, simulated_s, recorded_s, u)),
    )


def _shortest(times_s: Array) -> float:
    return float(np.min(np.diff(times_s))) if len(times_s) > 1 else math.inf


def _intervals(
    pairs: Sequence[tuple[int, int]], simulated_s: Array, recorded_s: Array, u: EventUncertainty
) -> Iterator[Interval]:
    number = 0
    for (i, j), (i_next, j_next) in itertools.pairwise(pairs):
        if i_next != i + 1 or j_next != j + 1:
            continue  # an event between them is missing in one of both
        number += 1
        u_num, u_input, u_data = u.of_interval(i, j)
        value = vv20(
            float(simulated_s[i_next] - simulated_s[i]),
            float(recorded_s[j_next] - recorded_s[j]),
            u_num=u_num, u_input=u_input, u_data=u_data,
        )  # fmt: skip
        yield Interval(number, value.simulated, value.measured, u_data, u_num, u_input, value.e_n)


def event_times(scene: Scenario, run: Trajectory, series: str) -> Array:
    """When the events of a simulation are [s].

    Args:
        scene: the scenario.
        run: what its probes saw: signal ``<probe>`` for each.
        series: what a measure of the scenario calls these times.
    """
    measure, name = _measure_of(scene, series)
    return measures.take(measure, observing(scene, tuple(run.signals)), run).series[name]


def _measure_of(scene: Scenario, series: str) -> tuple[Measure, str]:
    """The measure of a scenario that finds the times of events, and what it calls them itself.

    Raises:
        UnknownName: no measure of the scenario has such a series in seconds.
    """
    known = {
        measure.name_of(name): (measure, name)
        for measure in scene.measures
        for name in measures.load(measure.function).series
        if measures.units_of(measure, scene)[name] == "s"
    }
    if series not in known:
        raise UnknownName(f"series of times of {scene.name}", series, known)
    return known[series]
