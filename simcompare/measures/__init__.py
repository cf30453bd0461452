"""HOW GOOD: pure functions from a trajectory to measured values.

A measure is a module with ``measure(trajectory, request) -> Measured``; a scenario names it by
the module's name. In capitals it declares what :class:`Function` lists; with ``against`` it says
what is judged, else every value stands beside that of the truth. The same function measures engines
and closed forms, so a systematic error of the measure itself cancels in their difference.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import numpy as np

from simcompare.errors import SignalLacking, UnknownName
from simcompare.model.scenario import Measure, Probe, Scenario
from simcompare.model.trajectory import Array, Trajectory

#: one module each; those with an underscore are their parts
FUNCTIONS = tuple(sorted(path.stem for path in Path(__file__).parent.glob("[a-z]*.py")))
#: unit of a measured value that has the unit of its probe
OF_PROBE = "unit of the probe"


@dataclass(frozen=True)
class Request:
    """What a scenario asks of a measure.

    Attributes:
        probe: the leading probe.
        also: further probes by their role.
        options: numbers of the function.
    """

    probe: Probe
    also: Mapping[str, Probe] = field(default_factory=dict)
    options: Mapping[str, float] = field(default_factory=dict)

    def observed(self, trajectory: Trajectory, role: str | None = None) -> Array:
        """What the leading probe, or the one with a role, observes in a trajectory (n,).

        Raises:
            UnknownName: the request has no probe for that role, or the source no such signal.
        """
        if role is None:
            return observe(trajectory, self.probe)
        if role not in self.also:
            raise UnknownName("role of a probe", role, self.also)
        return observe(trajectory, self.also[role])


@dataclass(frozen=True)
class Measured:
    """What one measure found in one trajectory.

    Attributes:
        values: name -> one number; ``None`` where it could not be measured.
        series: name -> one number per event (n,), first event first.
        units: unit of every name, and of every series; ``take`` adds them.
        notes: what the reader should know.
        u: standard uncertainty of values that are a mean, from the scatter of what they are a mean
            of; it counts where a real recording is measured.
        lacking: why nothing could be measured, where the source does not give a signal.
        compared: arrays that only ``against`` needs.
    """

    values: Mapping[str, float | None]
    series: Mapping[str, Array] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    u: Mapping[str, float] = field(default_factory=dict)
    lacking: str = ""
    compared: Mapping[str, Array] = field(default_factory=dict)


Pairs = dict[str, tuple[float | None, float]]


@dataclass(frozen=True)
class Function:
    """A measure: what it is called with, gives and needs.

    Attributes:
        measure: measures one trajectory.
        against: values to be judged: name -> (value of the source, value of the truth).
        units: unit of every name (``OF_PROBE``: that of the leading probe).
        series: the names that are measured once per event.
        roles: roles of further probes that it needs.
        options: options that it needs.
        axes: series -> the series over which it is drawn, where that is not the event's number.
    """

    measure: Callable[[Trajectory, Request], Measured]
    against: Callable[[Measured, Measured], Pairs]
    units: Mapping[str, str]
    series: tuple[str, ...] = ()
    roles: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    axes: Mapping[str, str] = field(default_factory=dict)


@cache
def load(name: str) -> Function:
    """The measure of that name, from what its module declares in capitals.

    Raises:
        UnknownName: there is none.
    """
    if name not in FUNCTIONS:
        raise UnknownName("measure", name, FUNCTIONS)
    module = importlib.import_module(f"simcompare.measures.{name}")
    against = getattr(module, "against", side_by_side)
    declared = ("units", "series", "roles", "options", "axes")
    parts = {key: getattr(module, key.upper()) for key in declared if hasattr(module, key.upper())}
    return Function(module.measure, against, **parts)


def take(measure: Measure, scenario: Scenario, trajectory: Trajectory) -> Measured:
    """What a measure of a scenario finds in a trajectory, under the function's own names."""
    probe = scenario.probes[measure.probe]
    also = {role: scenario.probes[name] for role, name in measure.also.items()}
    function, units = load(measure.function), units_of(measure, scenario)
    try:
        measured = function.measure(trajectory, Request(probe, also, measure.options))
    except SignalLacking as error:
        nothing = {name: None for name in units if name not in function.series}
        empty = {name: np.array([]) for name in function.series}
        return Measured(nothing, empty, units, lacking=str(error))
    return replace(measured, units=units)


def units_of(measure: Measure, scenario: Scenario) -> dict[str, str]:
    """Units of what a measure finds, under the function's own names."""
    of_probe, units = scenario.probes[measure.probe].unit, load(measure.function).units
    return {name: of_probe if unit == OF_PROBE else unit for name, unit in units.items()}


def results_of(scenario: Scenario) -> dict[str, str]:
    """Every value that a scenario measures, by the scenario's own name -> its unit."""
    return {
        measure.name_of(name): unit
        for measure in scenario.measures
        for name, unit in units_of(measure, scenario).items()
    }


def side_by_side(measured: Measured, truth: Measured) -> Pairs:
    """Every value that the truth has, beside it."""
    return {
        name: (measured.values[name], true)
        for name, true in truth.values.items()
        if true is not None
    }


def observe(trajectory: Trajectory, probe: Probe) -> Array:
    """The scalar that a probe sees (n,), its offset added."""
    if probe.observe in trajectory.lacks:
        reason = trajectory.lacks[probe.observe]
        raise SignalLacking(trajectory.source, probe.observe, reason, trajectory.signals)
    if probe.observe not in trajectory.signals:
        raise UnknownName(f"signal of {trajectory.source}", probe.observe, trajectory.signals)
    values = trajectory.signals[probe.observe]
    if probe.component is not None and values.ndim == 2:
        values = values[:, probe.component]
    return values + probe.offset
