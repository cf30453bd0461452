"""Single values of two trajectories beside each other, as the measures of a scenario find them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from simcompare import measures
from simcompare.errors import SimcompareError
from simcompare.model.resampling import interpolated
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Trajectory


@dataclass(frozen=True)
class ValuePair:
    """One value, simulated and measured.

    Attributes:
        simulated: what the simulation gives.
        measured: what the measurement gives.
        unit: of both.
        probe: which probe leads.
        u: standard uncertainty of the measured value from its own scatter, 0 where it has none.
    """

    simulated: float
    measured: float
    unit: str
    probe: str
    u: float


def value_pairs(
    scene: Scenario, simulated: Trajectory, measured: Trajectory, probes: Sequence[str]
) -> dict[str, ValuePair]:
    """Every value that the scenario's measures find in both, by its name.

    Args:
        scene: the scenario.
        simulated: what its probes saw in a simulation: signal ``<probe>`` for each.
        measured: the same of a measurement.
        probes: those that were measured.
    """
    view = observing(scene, probes)
    pairs = {}
    for measure in scene.measures:
        if not {measure.probe, *measure.also.values()} <= set(probes):
            continue
        function = measures.load(measure.function)
        try:
            ours = measures.take(measure, view, simulated)
            theirs = measures.take(measure, view, measured)
        except SimcompareError:
            continue  # it needs what was not measured
        for name, (value, true) in function.against(ours, theirs).items():
            # what only the comparison makes, such as a largest deviation, is no measured value
            if value is not None and name in theirs.values:
                shown = measure.name_of(name)
                scatter = theirs.u.get(name, 0.0)
                pairs[shown] = ValuePair(value, true, ours.units[name], measure.probe, scatter)
    return pairs


def observing(scene: Scenario, probes: Sequence[str]) -> Scenario:
    """The scene with probes that look at a trajectory of what these probes saw."""
    changed = {
        name: scene.probes[name].model_copy(
            update={"observe": name, "component": None, "offset": 0.0}
        )
        for name in probes
    }
    return scene.model_copy(update={"probes": {**scene.probes, **changed}})


def overlap(measured: Trajectory, *simulated: Trajectory) -> Trajectory:
    """The part of a measurement that every simulation has too."""
    times = measured.time_s
    first, last = max(one.time_s[0] for one in simulated), min(one.time_s[-1] for one in simulated)
    inside = (times >= first) & (times <= last)
    signals = {name: values[inside] for name, values in measured.signals.items()}
    return Trajectory(measured.source, times[inside], signals)


def resampled(run: Trajectory, measured: Trajectory) -> Trajectory:
    """A simulation sampled when the measurement was, so that a measure sees both alike."""
    signals = {
        name: interpolated(run.time_s, run.signals[name], measured.time_s)
        for name in measured.signals
    }
    return Trajectory(run.source, measured.time_s, signals, run.version, run.contact)
