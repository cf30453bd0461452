"""Pictures of what a sensor reads: measured beside ideal, a panel for each axis."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from simcompare import units
from simcompare.hardware.sensors.error_model import Reading
from simcompare.hardware.sensors.signals import part_of
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import Style
from simcompare.reports.run import runs

_IDEAL = Style("#000000", width=2.0)
_MEASURED = Style("#0072B2", width=1.0)
_CUT = Style("#D55E00", marker="x")


def reading_figure(signal: str, unit: str, axes: str, reading: Reading, whose: str) -> Figure:
    """Measured and ideal over time.

    Args:
        signal: such as "imu.rate_rad_s".
        unit: of it, SI.
        axes: letters of its axes.
        reading: of the signal.
        whose: whose motion it is.
    """
    panels = tuple(
        Panel(f"axis {axes[i]}" if axes else "", "time (s)", _label(signal, unit), series)
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
