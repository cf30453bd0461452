"""Events of simulations beside those of a recording: figure and tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from simcompare.reports.render.figures import MOST_PANELS, Figure, Panel, Series, spread, style_of
from simcompare.reports.render.tables import Column, Group, Scale, Table, of_engines, scale_of
from simcompare.reports.run import runs
from simcompare.reports.validation import validations
from simcompare.results.run import Run

Record = Mapping[str, Any]
#: more intervals than these are folded away
_MOST_ROWS = 12


def timings(run: Run) -> list[Record]:
    """What is known of the events of each engine and stretch."""
    return list(validations.validation(run).get("timings") or ())


def _streams(rows: Sequence[Record]) -> list[str]:
    return list(dict.fromkeys(row["stream"] for row in rows))


def figure(run: Run) -> Figure | None:
    """Simulated minus measured length of every interval between two events."""
    rows = [row for row in timings(run) if row["intervals"]]
    streams = _streams(rows)[:MOST_PANELS]
    if not streams:
        return None
    panels = tuple(
        Panel(
            validations.stretch(run, stream), "interval between events", "simulated − measured (s)",
            tuple(_points([row for row in rows if row["stream"] == stream])), whole_x=True,
        )
        for stream in streams
    )  # fmt: skip
    caption = (
        "Each interval between two neighbouring events, which does not depend on where the clocks"
        " have their zero. Bars: twice the standard uncertainty of the difference, from the events"
        " of the recording, the step and the parameters, as far as they are known. A bar that"
        " reaches zero says that the difference cannot be told from the uncertainties."
    )
    title = f"{_first_up(runs.measure_words(rows[0]['series']))}: simulated and measured"
    return Figure("intervals", title, caption, panels)


def _first_up(text: str) -> str:
    return text[:1].upper() + text[1:]


def _points(rows: Sequence[Record]) -> list[Series]:
    found = []
    for i, row in enumerate(rows):
        spans = row["intervals"]
        x = np.array([one["number"] for one in spans]) + spread(i, len(rows), 0.5)
        y = np.array([one["simulated_s"] - one["measured_s"] for one in spans])
        u = np.array([2 * _u(one) for one in spans])
        name = row["source"]
        found.append(Series(name, x, y, style_of(name), u, points=True, line=False))
    return found


def _u(interval: Record) -> float:
    parts = (interval[key] for key in ("u_data_s", "u_num_s", "u_input_s"))
    return math.hypot(*(part or 0.0 for part in parts))


def summary(run: Run) -> Table | None:
    """How many events belong together and how far they are apart."""
    rows = timings(run)
    if not rows:
        return None
    columns = [Column("Matched"), Column("Missed"), Column("Extra"), Column("Bias"),
               Column("RMS error"), Column("Largest")]  # fmt: skip
    groups = []
    for stream in _streams(rows):
        own = [row for row in rows if row["stream"] == stream]
        scale = scale_of(row["rmse_s"] for row in own)
        where = validations.stretch(run, stream)
        title = runs.measure_words(own[0]["series"]) + (f", {where}" if where else "")
        groups.append(Group(title + scale.unit("s"), tuple(_summary(row, scale) for row in own)))
    note = (
        "Errors are simulated minus measured times of events that belong together. Missed: measured"
        " and not simulated; extra: simulated and not measured."
    )
    return of_engines(columns, groups, note)


def _summary(row: Record, scale: Scale) -> tuple[str, ...]:
    counts = (str(row[key]) for key in ("matched", "missed", "extra"))
    sizes = (scale.text(row[key]) for key in ("bias_s", "rmse_s", "max_abs_s"))
    return (row["source"], *counts, *sizes)


def intervals(run: Run) -> Table | None:
    """Every interval between two events."""
    rows = [row for row in timings(run) if row["intervals"]]
    if not rows:
        return None
    columns = (
        Column("Interval"), Column("Simulated (s)"), Column("Measured (s)"), Column("Error (s)"),
        Column("u data (s)", spare=True), Column("u numerical (s)", spare=True),
        Column("u parameters (s)", spare=True), Column("E_n"),
    )  # fmt: skip
    groups = []
    for row in rows:
        where = validations.stretch(run, row["stream"])
        groups.append(
            Group(row["source"] + (f", {where}" if where else ""),
                  tuple(map(_interval, row["intervals"])))
        )  # fmt: skip
    count = sum(len(row["intervals"]) for row in rows)
    return Table("Every interval", columns, tuple(groups), folded=count > _MOST_ROWS)


def _interval(one: Record) -> tuple[str, ...]:
    fine = Scale(0, 5)
    error = one["simulated_s"] - one["measured_s"]
    parts = (fine.text(one[key]) for key in ("u_data_s", "u_num_s", "u_input_s"))
    e_n = "–" if one["e_n"] is None else Scale(0, 2).text(one["e_n"])
    sizes = (fine.text(value) for value in (one["simulated_s"], one["measured_s"], error))
    return (str(one["number"]), *sizes, *parts, e_n)
