"""One segment of a recording with the reference that belongs to it, on one clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from simcompare.alignment.clock_line import Alignment
from simcompare.alignment.event_alignment import by_events
from simcompare.alignment.wave_alignment import by_waveform
from simcompare.comparison.events import event_times
from simcompare.errors import InputError
from simcompare.inference.estimate import Estimate
from simcompare.inference.plan import Plan
from simcompare.inference.propagation import moves
from simcompare.inference.reference_model import Model
from simcompare.inference.segments import Segment
from simcompare.inference.simulated import of_probes
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory

#: greatest skew that a clock may have; quartz has 1e-4 at most
MAX_SKEW = 1e-3


@dataclass(frozen=True)
class Evaluated:
    """One segment with all that its rows are made of.

    Attributes:
        segment: what was measured, on the clock of the scenario.
        scene: the scene with the best parameters.
        truth: the reference with the best parameters, by probe; ``None`` without a reference.
        nominal: the reference with the parameters known before.
        shifted: parameter, and what the reference gives when it moves by its standard uncertainty.
        recorded: what was measured on the recording's own clock, ``None`` where both are one.
        alignment: of the two clocks, ``None`` where they are one.
    """

    segment: Segment
    scene: Scenario
    truth: Trajectory | None = None
    nominal: Trajectory | None = None
    shifted: tuple[tuple[str, Trajectory], ...] = ()
    recorded: Segment | None = None
    alignment: Alignment | None = None

    def u_input(self, probe: str) -> Array | None:
        """Standard uncertainty from the parameters, at the reference's samples."""
        if self.truth is None:
            return None
        best = self.truth.signals[probe]
        parts = [run.signals[probe] - best for _, run in self.shifted]
        return np.sqrt(np.sum(np.square(parts), axis=0)) if parts else np.zeros_like(best)


def evaluate(
    model: Model, plan: Plan, segment: Segment, fit: Estimate | None, step_s: float | None
) -> Evaluated:
    """The reference of a segment, what its parameters make uncertain, and the clocks aligned.

    Raises:
        InputError: the clocks cannot be aligned.
    """
    best = {} if fit is None else fit.as_dict()
    scene = model.scenario(segment, best, step_s)
    if model.reference is None:
        return Evaluated(segment, scene)

    def at(values: Mapping[str, float], segment: Segment = segment) -> Trajectory:
        moved = model.scenario(segment, values, step_s)
        return of_probes(moved, model.truth(moved), segment.watched)

    truth = at(best)
    shifted = [(name, at(values)) for name, values in moves(model.file, segment, fit).items()]
    shifted += [
        (f"input {name}", at(best, segment.with_input_moved(name))) for name in segment.u_inputs
    ]
    evaluated = Evaluated(segment, scene, truth, at({}), tuple(shifted))
    alignment = _aligned(plan, segment, scene, truth)
    if alignment is None:
        return evaluated
    return replace(
        evaluated, segment=_on_reference(segment, alignment), recorded=segment, alignment=alignment
    )


def times_of_events(segment: Segment) -> tuple[Array, Array | None]:
    """When the events of a segment were, and their standard uncertainties where all are known."""
    times_s = np.array([event.time_s for event in segment.events])
    u = [event.u_s for event in segment.events]
    return times_s, None if None in u else np.array(u, dtype=float)


def _aligned(plan: Plan, segment: Segment, scene: Scenario, truth: Trajectory) -> Alignment | None:
    if plan.align.by == "events" and plan.events is not None:
        return _plausible(
            segment, _by_events(segment, event_times(scene, truth, plan.events.series))
        )
    probe = plan.align.probe
    if probe is None:
        return None
    measured = segment.observed[probe]
    alignment = by_waveform(truth.time_s, truth.signals[probe], measured.time_s, measured.values)
    return _plausible(segment, alignment)


def _by_events(segment: Segment, expected_s: Array) -> Alignment:
    """The clock of the recording against that of the scenario, by their events."""
    measured_s, u = times_of_events(segment)
    if len(expected_s) < 2 or len(measured_s) < 2:
        raise InputError(
            f"stream {segment.stream}",
            [
                f"{len(measured_s)} events and {len(expected_s)} simulated ones; two of both are"
                " needed"
            ],
        )
    return by_events(expected_s, measured_s, u)


def _plausible(segment: Segment, alignment: Alignment) -> Alignment:
    """The alignment, where it can be believed.

    Raises:
        InputError: a skew that no clock has, or fewer than half of the events matched.
    """
    events = len(alignment.matched) + len(alignment.extra)
    if abs(alignment.skew) > MAX_SKEW or (events and len(alignment.matched) < 0.5 * events):
        raise InputError(
            f"stream {segment.stream}, align",
            [
                f"the clocks cannot be aligned: {alignment.text} The parameters that are known may"
                " be too far off; mend them with --set, or calibrate them"
            ],
        )
    return alignment


def _on_reference(segment: Segment, alignment: Alignment) -> Segment:
    observed = {
        probe: replace(one, time_s=alignment.to_reference(one.time_s))
        for probe, one in segment.observed.items()
    }
    events = tuple(
        replace(event, time_s=float(alignment.to_reference(np.array([event.time_s]))[0]))
        for event in segment.events
    )
    return replace(segment, observed=observed, events=events)
