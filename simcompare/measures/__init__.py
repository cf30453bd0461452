"""HOW GOOD: pure functions from a trajectory to measured values.

A measure is a module with ``measure(trajectory, request) -> Measured``; a scenario names it by
the module's name. The same function measures engines and closed forms, so a systematic error of the
measure itself cancels in their difference.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol, cast

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

    def seen(self, trajectory: Trajectory, role: str | None = None) -> Array:
        """What the leading probe sees in a trajectory (n,), or the one with a role.

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
        units: unit of every name, and of every series.
        notes: what the reader should know.
        u: standard uncertainty of values that are a mean, from the scatter of what they are a mean
            of; it counts where a real recording is measured.
        lacking: why nothing could be measured, where the source does not give a signal.
    """

    values: Mapping[str, float | None]
    series: Mapping[str, Array]
    units: Mapping[str, str]
    notes: tuple[str, ...] = field(default=())
    u: Mapping[str, float] = field(default_factory=dict)
    lacking: str = ""


class MeasureModule(Protocol):
    """What a module in this folder offers.

    Attributes:
        UNITS: unit of every name (``OF_PROBE``: that of the leading probe).
        SERIES: the names that are measured once per event.
        ROLES: roles of further probes that it needs.
        OPTIONS: options that it needs.
        AXES: series -> the series over which it is drawn, where that is not the event's number.
    """

    UNITS: Mapping[str, str]
    SERIES: tuple[str, ...]
    ROLES: tuple[str, ...]
    OPTIONS: tuple[str, ...]
    AXES: Mapping[str, str]

    def measure(self, trajectory: Trajectory, request: Request) -> Measured:
        """Measures one trajectory."""


class Judge(Protocol):
    """What a module may offer besides, as ``against``; without it values stand side by side."""

    def __call__(
        self, measured: Measured, truth: Measured
    ) -> dict[str, tuple[float | None, float]]:
        """Values to be judged: name -> (value of the source, value of the truth)."""


def load(name: str) -> MeasureModule:
    """The measure of that name.

    Raises:
        UnknownName: there is none.
    """
    if name not in FUNCTIONS:
        raise UnknownName("measure", name, FUNCTIONS)
    return cast(MeasureModule, importlib.import_module(f"simcompare.measures.{name}"))


def take(measure: Measure, scenario: Scenario, trajectory: Trajectory) -> Measured:
    """What a measure of a scenario finds in a trajectory, under the function's own names."""
    probe = scenario.probes[measure.probe]
    also = {role: scenario.probes[name] for role, name in measure.also.items()}
    module, units = load(measure.function), units_of(measure, scenario)
    try:
        found = module.measure(trajectory, Request(probe, also, measure.options))
    except SignalLacking as error:
        nothing = {name: None for name in units if name not in module.SERIES}
        empty = {name: np.array([]) for name in module.SERIES}
        return Measured(nothing, empty, units, lacking=str(error))
    return replace(found, units=units)


def units_of(measure: Measure, scenario: Scenario) -> dict[str, str]:
    """Units of what a measure finds, under the function's own names."""
    own = scenario.probes[measure.probe].unit
    units = load(measure.function).UNITS
    return {name: own if unit == OF_PROBE else unit for name, unit in units.items()}


def judge_of(measure: Measure) -> Judge:
    """How what a measure finds is set against the truth."""
    return cast(Judge, getattr(load(measure.function), "against", side_by_side))


def side_by_side(measured: Measured, truth: Measured) -> dict[str, tuple[float | None, float]]:
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
