"""Events of simulations beside those of a recording: figure and tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from simcompare.comparison.events import Interval
from simcompare.reports.render.figures import MAX_PANELS, Figure, Panel, Series, spread
from simcompare.reports.render.styles import style_of
from simcompare.reports.render.tables import Column, Group, Scale, Table, of_engines, scale_of
from simcompare.reports.run import runs
from simcompare.reports.validation import phrases, validations
from simcompare.results.records.validation import TimingRecord
from simcompare.results.run import Run

#: more intervals than these are folded away
_MAX_ROWS = 12


def _streams(rows: Sequence[TimingRecord]) -> list[str]:
    return list(dict.fromkeys(row.stream for row in rows))


def figure(run: Run) -> Figure | None:
    """Simulated minus measured length of every interval between two events."""
    rows = [row for row in validations.validation(run).timings if row.intervals]
    streams = _streams(rows)[:MAX_PANELS]
    if not streams:
        return None
    panels = tuple(
        Panel(
            validations.segment_name(run, stream), "interval between events",
            "simulated − measured (s)",
            tuple(_points([row for row in rows if row.stream == stream])), integer_x=True,
        )
        for stream in streams
    )  # fmt: skip
    caption = (
        "Each interval between two neighbouring events. Bars: twice the standard uncertainty of the"
        " difference, as far as it is known. A bar that reaches zero: they agree."
    )
    title = f"{phrases.first_up(runs.measure_words(rows[0].series))}: simulated and measured"
    return Figure("intervals", title, caption, panels)


def _points(rows: Sequence[TimingRecord]) -> list[Series]:
    series = []
    for i, row in enumerate(rows):
        spans = row.intervals
        x = np.array([one.number for one in spans]) + spread(i, len(rows), 0.5)
        y = np.array([one.simulated_s - one.measured_s for one in spans])
        u = np.array([2 * _u(one) for one in spans])
        name = row.source
        series.append(Series(name, x, y, style_of(name), u, points=True, line=False))
    return series


def _u(interval: Interval) -> float:
    return math.hypot(*(part or 0.0 for part in _parts(interval)))


def _parts(interval: Interval) -> tuple[float | None, float | None, float | None]:
    return interval.u_data_s, interval.u_num_s, interval.u_input_s


def summary(run: Run) -> Table | None:
    """How many events belong together and how far they are apart."""
    rows = validations.validation(run).timings
    if not rows:
        return None
    columns = [Column("Matched"), Column("Missed"), Column("Extra"), Column("Bias"),
               Column("RMS error"), Column("Largest")]  # fmt: skip
    groups = []
    for stream in _streams(rows):
        of_stream = [row for row in rows if row.stream == stream]
        scale = scale_of(row.rmse_s for row in of_stream)
        title = validations.titled(run, stream, runs.measure_words(of_stream[0].series))
        groups.append(
            Group(title + scale.unit("s"), tuple(_summary(row, scale) for row in of_stream))
        )
    note = (
        "Errors: simulated minus measured times. Missed: measured and not simulated. Extra:"
        " simulated and not measured."
    )
    return of_engines(columns, groups, note)


def _summary(row: TimingRecord, scale: Scale) -> tuple[str, ...]:
    counts = map(str, (row.matched, row.missed, row.extra))
    sizes = map(scale.text, (row.bias_s, row.rmse_s, row.max_abs_s))
    return (row.source, *counts, *sizes)


def intervals(run: Run) -> Table | None:
    """Every interval between two events."""
    rows = [row for row in validations.validation(run).timings if row.intervals]
    if not rows:
        return None
    columns = (
        Column("Interval"), Column("Simulated (s)"), Column("Measured (s)"), Column("Error (s)"),
        Column("u data (s)", spare=True), Column("u numerical (s)", spare=True),
        Column("u parameters (s)", spare=True), Column("E_n"),
    )  # fmt: skip
    groups = [
        Group(validations.titled(run, row.stream, row.source), tuple(map(_interval, row.intervals)))
        for row in rows
    ]
    count = sum(len(row.intervals) for row in rows)
    return Table("Every interval", columns, tuple(groups), folded=count > _MAX_ROWS)


def _interval(one: Interval) -> tuple[str, ...]:
    fine = Scale(0, 5)
    error = one.simulated_s - one.measured_s
    parts = map(fine.text, _parts(one))
    e_n = "–" if one.e_n is None else Scale(0, 2).text(one.e_n)
    sizes = (fine.text(value) for value in (one.simulated_s, one.measured_s, error))
    return (str(one.number), *sizes, *parts, e_n)
