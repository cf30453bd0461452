"""Figures of engines beside a measurement."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare.comparison.against import Match
from simcompare.model.trajectory import Array
from simcompare.reports.render.figures import Band, Figure, Panel, Series, fitted_range, spread
from simcompare.reports.render.styles import MEASURED_STYLE, Style
from simcompare.reports.run import runs
from simcompare.reports.run.event_values import column, deviation_scale, deviation_unit
from simcompare.reports.run.listing import grouped
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

Rows = Sequence[Match]
#: engines stand this far apart about their event, so that none hides another
_SPREAD = 0.6


def matches_of(run: Run) -> tuple[Match, ...]:
    """Every measured value beside every source's."""
    against = runs.run_record(run).against
    return () if against is None else against.matches


def measured_figures(run: Run) -> tuple[Figure, ...]:
    """A figure for each measured quantity."""
    quantities = dict.fromkeys(row.quantity for row in matches_of(run))
    return tuple(_figure(run, quantity) for quantity in quantities)


def _figure(run: Run, quantity: str) -> Figure:
    """Every engine beside the measured values of one quantity, one panel a contact level."""
    matches = [row for row in matches_of(run) if row.quantity == quantity]
    several = len({row.bounce for row in matches}) > 1
    by_mode = {mode: [r for r in matches if r.contact == mode] for mode in runs.modes(run)}
    panel = _by_event if several else _by_engine
    panels = tuple(panel(run, mode, rows) for mode, rows in by_mode.items() if rows)
    if several:
        caption = (
            "Deviations from the measured values; black bars are the measurement's limits,"
            " ± 2u where none are stated."
        )
    else:
        caption = "The shaded band is the measurement."
    if len(panels) > 1:
        caption += " Mind the scales: each panel has its own."
    if not several and any(row.value is None for row in matches):
        caption += " (none): there is no such event in the engine."
    title = f"Measured {runs.measure_words(quantity)}"
    return Figure(f"measured-{quantity}", title, caption, panels)


def _by_engine(run: Run, mode: str, rows: Rows) -> Panel:
    """One measured value: a band, and the engines side by side."""
    band = _band(rows[0])
    ticks = tuple(f"{row.source}\n(none)" if row.value is None else row.source for row in rows)
    series = tuple(
        _points(row.source, np.array([float(i)]), column([row], "value"), look(run, row.source),
                column([row], "scatter"))
        for i, row in enumerate(rows)
    )  # fmt: skip
    return Panel(
        runs.mode_title(mode), "", runs.label(rows[0].quantity, rows[0].unit), series, (band,),
        ticks, y_range=fitted_range(series, (band,)),
    )  # fmt: skip


def _by_event(run: Run, mode: str, rows: Rows) -> Panel:
    """Several measured events: deviations, for on one scale no engine can be told from another."""
    by_source = grouped((row.source, row) for row in rows)
    first, count = by_source[rows[0].source], len(by_source) + 1
    relative = all(row.measured for row in first)
    bands = [_band(row) for row in first]
    low, high = column(bands, "low"), column(bands, "high")
    measured = column(first, "measured")
    scale = deviation_scale(measured, relative=relative)
    x = column(first, "bounce") + spread(0, count, _SPREAD)
    y, u = ((high + low) / 2 - measured) * scale, (high - low) / 2 * scale
    series = [_points("measured", x, y, MEASURED_STYLE, u)]
    for i, (name, matches) in enumerate(by_source.items(), start=1):
        measured = column(matches, "measured")
        scale = deviation_scale(measured, relative=relative)
        x = column(matches, "bounce") + spread(i, count, _SPREAD)
        y, u = (column(matches, "value") - measured) * scale, column(matches, "scatter") * scale
        series.append(_points(name, x, y, look(run, name), u))
    unit = deviation_unit(rows[0].unit, relative=relative)
    label = f"{runs.measure_words(rows[0].quantity)} − measured{unit}"
    title = runs.mode_title(mode)
    return Panel(title, "number of the event", label, tuple(series), integer_x=True)


def _points(label: str, x: Array, y: Array, style: Style, u: Array) -> Series:
    return Series(label, x, y, style, u, points=True, line=False)


def _band(row: Match) -> Band:
    centre = float(row.measured)
    if row.low is not None and row.high is not None:
        return Band(float(row.low), float(row.high), "measured, stated limits", centre)
    half = 2 * float(row.u_measured or 0.0)
    label = "measured ± 2u" if half else "measured"
    return Band(centre - half, centre + half, label, centre)
