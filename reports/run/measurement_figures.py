"""Figures of engines beside a measurement."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from simcompare.compare.against import Match
from simcompare.model.trajectory import Array
from simcompare.reports.render.figures import (
    MEASURED_STYLE,
    Band,
    Figure,
    Panel,
    Series,
    fitted_range,
    spread,
)
from simcompare.reports.run import runs
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

Rows = Sequence[Match]
#: engines stand this far apart about their event, so that none hides another
_SPREAD = 0.6


def matches_of(run: Run) -> tuple[Match, ...]:
    """Every measured value beside every source's."""
    against = runs.own_record(run).against
    return () if against is None else against.matches


def quantities(run: Run) -> list[str]:
    """Names of the measured quantities."""
    return list(dict.fromkeys(row.quantity for row in matches_of(run)))


def measured_figure(run: Run, quantity: str) -> Figure:
    """Every engine beside the measured values of one quantity, one panel a contact level."""
    matches = [row for row in matches_of(run) if row.quantity == quantity]
    several = len({row.bounce for row in matches}) > 1
    panels = []
    for mode in runs.modes(run):
        rows = [row for row in matches if row.contact == mode]
        if rows:
            panels.append((_by_event if several else _by_engine)(run, mode, rows))
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
    words = runs.measure_words(quantity)
    title = f"Measured {words}"
    return Figure(f"measured-{quantity}", title, caption, tuple(panels))


def _by_engine(run: Run, mode: str, rows: Rows) -> Panel:
    """One measured value: a band, and the engines side by side."""
    first = rows[0]
    band = _band(first)
    ticks, series = [], []
    for i, row in enumerate(rows):
        ticks.append(f"{row.source}\n(none)" if row.value is None else str(row.source))
        y, u = _floats([row], "value"), _floats([row], "scatter")
        x, style = np.array([float(i)]), look(run, row.source)
        series.append(Series(row.source, x, y, style, u, points=True, line=False))
    drawn = tuple(series)
    return Panel(
        runs.mode_title(mode), "", _y_label(first), drawn, (band,), tuple(ticks),
        y_range=fitted_range(drawn, (band,)),
    )  # fmt: skip


def _by_event(run: Run, mode: str, rows: Rows) -> Panel:
    """Several measured events: deviations, for on one scale no engine can be told from another."""
    own = [row for row in rows if row.source == rows[0].source]
    relative = all(row.measured for row in own)
    names = [*dict.fromkeys(str(row.source) for row in rows)]
    count = len(names) + 1
    half = np.array([(band.high - band.low) / 2 for band in map(_band, own)]) * _scale(
        own, relative
    )
    place = _floats(own, "bounce") + spread(0, count, _SPREAD)
    centre = np.array([(band.high + band.low) / 2 for band in map(_band, own)])
    zero = (centre - _floats(own, "measured")) * _scale(own, relative)
    series = [
        Series("measured", place, zero, MEASURED_STYLE, half, points=True, line=False),
    ]
    for i, name in enumerate(names):
        found = [row for row in rows if row.source == name]
        scale = _scale(found, relative)
        y = (_floats(found, "value") - _floats(found, "measured")) * scale
        x = _floats(found, "bounce") + spread(i + 1, count, _SPREAD)
        u = _floats(found, "scatter") * scale
        series.append(Series(name, x, y, look(run, name), u, points=True, line=False))
    unit = " (%)" if relative else runs.unit_words(rows[0].unit)
    label = f"{runs.measure_words(rows[0].quantity)} − measured{unit}"
    title = runs.mode_title(mode)
    return Panel(title, "number of the event", label, tuple(series), whole_x=True)


def _scale(rows: Rows, relative: bool) -> Array:
    """Factors that turn deviations into per cent of the measured value, or leave them."""
    return 100 / np.abs(_floats(rows, "measured")) if relative else np.ones(len(rows))


def _band(row: Match) -> Band:
    centre = float(row.measured)
    if row.low is not None and row.high is not None:
        return Band(float(row.low), float(row.high), "measured, stated limits", centre)
    half = 2 * float(row.u_measured or 0.0)
    label = "measured ± 2u" if half else "measured"
    return Band(centre - half, centre + half, label, centre)


def _y_label(row: Match) -> str:
    return f"{runs.measure_words(row.quantity)}{runs.unit_words(row.unit)}"


def _floats(rows: Rows, key: str) -> Array:
    values = [getattr(row, key) for row in rows]
    return np.array([math.nan if value is None else float(value) for value in values])
