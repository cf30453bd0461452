"""HOW GOOD: pure functions from a trajectory to measured values.

A measure is a module with ``measure(trajectory, probe) -> Measured``; a scenario names it by
the module's name. The same function measures engines and closed forms, so a systematic error of the
measure itself cancels in their difference.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol, cast

from simcompare.errors import UnknownName
from simcompare.scenario import Probe
from simcompare.trajectory import Array, Trajectory

FUNCTIONS = ("bounces",)


@dataclass(frozen=True)
class Measured:
    """What one measure found in one trajectory.

    Attributes:
        values: name -> one number; ``None`` where it could not be measured.
        series: name -> one number per event (n,), first event first.
        units: unit of every name, and of every series.
        notes: what the reader should know.
    """

    values: Mapping[str, float | None]
    series: Mapping[str, Array]
    units: Mapping[str, str]
    notes: tuple[str, ...] = field(default=())


class MeasureModule(Protocol):
    """What a module in this folder offers: units of all names, and which are one per event."""

    UNITS: Mapping[str, str]
    SERIES: tuple[str, ...]

    def measure(self, trajectory: Trajectory, probe: Probe) -> Measured:
        """Measures one trajectory."""

    def against(self, measured: Measured, truth: Measured) -> dict[str, tuple[float | None, float]]:
        """Values to be judged: name -> (value of the source, value of the truth)."""


def load(name: str) -> MeasureModule:
    """The measure of that name.

    Raises:
        UnknownName: there is none.
    """
    if name not in FUNCTIONS:
        raise UnknownName("measure", name, FUNCTIONS)
    return cast(MeasureModule, importlib.import_module(f"simcompare.measures.{name}"))


def observe(trajectory: Trajectory, probe: Probe) -> Array:
    """The scalar that a probe sees (n,), its offset added."""
    if probe.observe not in trajectory.signals:
        raise UnknownName(f"signal of {trajectory.source}", probe.observe, trajectory.signals)
    values = trajectory.signals[probe.observe]
    if probe.component is not None and values.ndim == 2:
        values = values[:, probe.component]
    return values + probe.offset
