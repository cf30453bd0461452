"""What drives a scene: torques, forces and voltages of its actuators over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simcompare import units
from simcompare.model.trajectory import Array, Trajectory
from simcompare.notation import capital
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import MAX_PANELS, Figure, Panel, Series
from simcompare.reports.render.styles import Style, numbered_style
from simcompare.reports.run import runs
from simcompare.reports.run.listing import grouped, joined
from simcompare.reports.run.motion_figures import TIME
from simcompare.results.run import Run

#: what an actuator records; where it has a voltage, its torque follows from that
_VOLTAGE = "voltage_V"
_EFFORTS = ("torque_N_m", "force_N")


@dataclass(frozen=True, eq=False)
class Drive:
    """What actuators do that all do the same.

    Attributes:
        names: of the actuators, in words.
        quantity: torque, force or voltage, with its unit as a suffix.
        values: over time (n,).
    """

    names: tuple[str, ...]
    quantity: str
    values: Array

    @property
    def is_constant(self) -> bool:
        """Whether it is the same from the beginning to the end."""
        return bool(np.ptp(self.values) <= numbers.ROUNDING * np.abs(self.values).max())

    @property
    def unit(self) -> str:
        """Of the values."""
        return units.symbol(units.unit_of(self.quantity))

    @property
    def what(self) -> str:
        """Torque, force or voltage."""
        return runs.measure_words(self.quantity.removesuffix(units.suffix_of(self.quantity)))

    @property
    def words(self) -> str:
        """What it is, and its value where that is constant."""
        value = f"{numbers.plain(float(self.values[0]), 4)} {self.unit}, constant"
        return f"{self.what} of the {joined(self.names)}" + (
            f": {value}" if self.is_constant else ""
        )


def drives(run: Run) -> list[Drive]:
    """What each actuator does, those together that do the same; empty where there is none."""
    source = _source(run)
    found = _signals(source.signals) if source is not None else {}
    same = grouped(((key[1], values.tobytes()), key[0]) for key, values in found.items())
    return [
        Drive(tuple(map(runs.measure_words, owners)), quantity, found[owners[0], quantity])
        for (quantity, _), owners in same.items()
    ]


def drive_figure(run: Run) -> Figure | None:
    """A panel each for torques, forces and voltages; ``None`` where nothing drives the scene."""
    every, source = drives(run), _source(run)
    if not every or source is None:
        return None
    by_quantity = grouped((drive.quantity, drive) for drive in every)
    styles = {drive: numbered_style(i) for i, drive in enumerate(every)}
    panels = [_panel(source.time_s, drawn, styles) for drawn in by_quantity.values()]
    caption = f"Recorded in {source.source}, {runs.mode_words(source.contact)}."
    return Figure("drive", "What drove it", caption, tuple(panels[:MAX_PANELS]))


def _panel(time_s: Array, drawn: list[Drive], styles: Mapping[Drive, Style]) -> Panel:
    series = [
        Series(capital(joined(drive.names)), time_s, drive.values, styles[drive]) for drive in drawn
    ]
    first = drawn[0]
    return Panel(first.what, TIME, f"{first.what}{runs.unit_words(first.unit)}", tuple(series))


def _source(run: Run) -> Trajectory | None:
    """The first engine that ran, where engines were given the scenario's physics."""
    for mode in reversed(runs.judged_modes(run)):
        for name in runs.ran(run, mode):
            return runs.nominal(run, name, mode)
    return None


def _signals(signals: Mapping[str, Array]) -> dict[tuple[str, str], Array]:
    """Scalar efforts and voltages by actuator; forces of sensors are vectors."""
    found = {}
    for signal, values in signals.items():
        owner, _, quantity = signal.rpartition(".")
        if values.ndim != 1 or quantity not in (*_EFFORTS, _VOLTAGE):
            continue
        if quantity == _VOLTAGE or f"{owner}.{_VOLTAGE}" not in signals:
            found[owner, quantity] = values
    return found
