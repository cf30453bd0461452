"""One segment of a recording with the parameters and inputs that belong to it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from simcompare import units
from simcompare.model.recording import Event
from simcompare.model.signals import Signal, Table
from simcompare.model.trajectory import Array, Trajectory
from simcompare.statistics.agreement import rms
from simcompare.statistics.noise import measured_noise

#: parameter of a scenario that says how long it lasts
DURATION = "duration_s"
#: what recorded inputs are stored under
INPUT = "input"


@dataclass(frozen=True)
class Observed:
    """What was measured of one probe.

    Attributes:
        time_s: (n,), from the start of the scenario [s].
        values: (n,), nothing missing.
        u: standard uncertainty of a sample, ``None`` where unknown: one number or (n,).
        missing: samples that were not measured.
        saturated: samples that were left out because the sensor was at its end.
    """

    time_s: Array
    values: Array
    u: float | Array | None
    missing: int = 0
    saturated: int = 0


@dataclass(frozen=True)
class Segment:
    """One segment of a recording.

    Attributes:
        stream: its stream.
        start_s: where it begins on the clock of its stream [s].
        duration_s: how long it lasts [s].
        values: every parameter that the plan knows or that was read off.
        u: their standard uncertainties.
        inputs: signals of the inputs.
        observed: probe -> what was measured.
        events: what happened, on the clock of the scenario.
        watched: all probes that are looked at, those of the events included.
        u_inputs: standard uncertainty of an input, where its channel has one.
        short: whether the log ends before the window does.
        input_units: unit of each input as it was logged.
    """

    stream: str
    start_s: float
    duration_s: float
    values: Mapping[str, float]
    u: Mapping[str, float]
    inputs: Mapping[str, Signal] = field(repr=False)
    observed: Mapping[str, Observed] = field(repr=False)
    events: tuple[Event, ...] = ()
    watched: tuple[str, ...] = ()
    u_inputs: Mapping[str, float] = field(default_factory=dict)
    short: bool = False
    input_units: Mapping[str, str] = field(default_factory=dict)

    def with_input_moved(self, name: str) -> Segment:
        """The same with one input higher by its standard uncertainty, as if its zero were off."""
        signal = self.inputs[name]
        assert isinstance(signal, Table)
        moved = tuple(value + self.u_inputs[name] for value in signal.value)
        table = signal.model_copy(update={"value": moved})
        return replace(self, inputs={**self.inputs, name: table})


def noise(observed: Observed) -> tuple[float, str]:
    """Standard uncertainty of one sample and where it comes from."""
    if observed.u is not None:
        return rms(observed.u), "stated"
    estimated = measured_noise(observed.values)
    return estimated.value, estimated.text


def shares(observed: Observed) -> tuple[float, float]:
    """The part of the uncertainty that scatters from sample to sample, and the common part."""
    total = noise(observed)[0]
    random = min(measured_noise(observed.values).value, total)
    return random, math.sqrt(max(0.0, total**2 - random**2))


def inputs_of(segment: Segment) -> dict[str, Trajectory]:
    """The recorded inputs, each as a trajectory whose signal is called as it is shown."""
    found = {}
    for name, table in segment.inputs.items():
        if isinstance(table, Table):
            unit = units.symbol(segment.input_units.get(name, "1"))
            label = name.replace("_", " ") + ("" if unit == "1" else f" ({unit})")
            signals = {label: np.array(table.value)}
            found[name] = Trajectory(INPUT, np.array(table.time_s), signals)
    return found


def as_trajectory(segment: Segment) -> Trajectory:
    """What was measured as a trajectory: the probes that have the clock of the leading one."""
    observed = list(segment.observed.values())
    times = observed[0].time_s
    same = {
        probe: one.values
        for probe, one in segment.observed.items()
        if len(one.time_s) == len(times) and np.array_equal(one.time_s, times)
    }
    return Trajectory("measured", times, same)
