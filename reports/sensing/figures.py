"""Pictures of what a sensor reads: measured beside ideal, a panel for each axis."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from simcompare import units
from simcompare.hardware.sensors.drawn_zones import ZoneReading
from simcompare.hardware.sensors.error_model import Reading
from simcompare.hardware.sensors.signals import part_of
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import Style
from simcompare.reports.run import runs
from simcompare.reports.sensing import zones
from simcompare.results.records.sensing import SensorRecord

_IDEAL = Style("#000000", width=2.0)
_MEASURED = Style("#0072B2", width=1.0)
_CUT = Style("#D55E00", marker="x")


def reading_figure(sensor: SensorRecord, reading: Reading | ZoneReading, whose: str) -> Figure:
    """Measured and ideal: over time, or the last frame of many zones.

    Args:
        sensor: what was read.
        reading: of its signal.
        whose: whose motion it is.
    """
    signal, axes = sensor.signal, sensor.axes
    if isinstance(reading, ZoneReading):
        return zones.frame_figure(signal, reading, whose)
    panels = tuple(
        Panel(f"axis {axes[i]}" if axes else "", "time (s)", _label(signal, sensor.unit), series)
        for i, series in enumerate(_rows(reading))
    )
    caption = (
        f"Ideal: what {whose} gives. Measured: what the drawn device makes of it, with its errors,"
        " noise, bandwidth, clock and counts."
    )
    name = f"sensor-{signal.replace('.', '-')}"
    return Figure(name, f"What {signal} reads", caption, panels)


def _rows(reading: Reading) -> Iterator[tuple[Series, ...]]:
    """The lines of each axis."""
    count = len(reading.time_s)
    columns = (
        np.reshape(one, (count, -1)).T
        for one in (reading.ideal, reading.measured, reading.saturated)
    )
    for ideal, measured, cut in zip(*columns, strict=True):
        lines = (
            Series("measured", reading.time_s, measured, _MEASURED),
            Series("ideal", reading.time_s, ideal, _IDEAL),
        )
        ends = np.where(cut, measured, np.nan)
        points = Series("saturated", reading.time_s, ends, _CUT, points=True, line=False)
        yield (*lines, points) if cut.any() else lines


def _label(signal: str, unit: str) -> str:
    """Quantity and unit."""
    part = part_of(signal)
    words = part.removesuffix(units.suffix_of(part)).replace("_", " ")
    return f"{words}{runs.unit_words(units.symbol(unit))}"
