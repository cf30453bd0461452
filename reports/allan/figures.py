"""The Allan plot: deviations with their bounds, the fit, and the line of a data sheet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare.hardware.sensors import noise_units
from simcompare.reports.allan import words
from simcompare.reports.render.figures import MAX_PANELS, Figure, Panel, Series
from simcompare.reports.render.styles import Style, numbered_style
from simcompare.results.records.allan import AxisNoise, NoiseAnalysis

_SHEET = Style("#888888", "longdash", width=2.0)


def plot(found: NoiseAnalysis) -> Figure:
    """A panel for each kind of sensor."""
    panels = tuple(
        _panel(unit, axes, found) for unit, axes in list(words.by_unit(found).items())[:MAX_PANELS]
    )
    sheet = (
        f" The grey lines are white noise as {found.against[0].sheet} states it."
        if found.against else ""
    )  # fmt: skip
    return Figure(
        "allan",
        f"How the noise averages out: {found.title}",
        "Overlapping Allan deviation (points) with 95 % bounds (shaded), and the fitted noises"
        " (lines). A slope of −1/2 is white noise, a flat part bias instability, +1/2 a random walk"
        f" of the rate.{sheet}",
        panels,
    )


def _panel(unit: str, axes: Sequence[AxisNoise], found: NoiseAnalysis) -> Panel:
    name, size = noise_units.of_sheets("B", unit)
    series: list[Series] = []
    for i, axis in enumerate(axes):
        series += _of_axis(axis, i, size)
    stated = [row for row in found.against if row.channel in {axis.channel for axis in axes}]
    for row in {row.stated: row for row in stated}.values():
        tau = np.array([axes[0].tau_s[0], axes[0].tau_s[-1]])
        line = row.stated / np.sqrt(2 * tau) / size
        series.append(Series(f"{row.sheet}, white noise", tau, line, _SHEET))
    title = words.sensor(unit).capitalize()
    return Panel(
        title, "Averaging time τ (s)", f"Allan deviation ({name})", tuple(series),
        log_x=True, log_y=True,
    )  # fmt: skip


def _of_axis(axis: AxisNoise, number: int, size: float) -> list[Series]:
    style = numbered_style(number)
    tau, low, high = np.array(axis.tau_s), np.array(axis.low) / size, np.array(axis.high) / size
    label = words.short(axis.channel)
    bounds = Series(label, tau, (low + high) / 2, style, (high - low) / 2, line=False, shaded=True)
    points = Series(label, tau, np.array(axis.deviation) / size, style, points=True, line=False)
    seen = tau >= 0.99 * axis.from_s  # what is faster was not fitted
    fit = Series(f"{label}, fit", tau[seen], np.array(axis.fitted)[seen] / size, style)
    return [bounds, fit, points]
