"""Tables and figures of a fit for plain loops: what to type in, and what each impact then does."""

from __future__ import annotations

import numpy as np

from simcompare.reports.fit import engine_words, fits
from simcompare.reports.fit.fits import CLOSED
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Figure, Panel, Series, spread
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.validation import validations
from simcompare.results.records.fit_engines import Impact
from simcompare.results.records.fit_holdout import PredictedHeight
from simcompare.results.run import Run

_ZERO = Style("#7F7F7F", "dot", width=2.0)


def typed(run: Run) -> Table:
    """What a user types in, engine by engine, and what the engine does with it."""
    record = fits.bounces(run)
    goal, mean = record.tuned_to, record.tuned_mean
    assert goal is not None
    rows: list[tuple[str, ...]] = [
        (CLOSED, "–", numbers.with_u(goal.restitution, goal.u),
         numbers.with_u(mean, record.u_tuned_mean), "–")
    ]  # fmt: skip
    for source in fits.engines(run):
        first, effective = source.impacts[0], source.effective["restitution"]
        cells = (
            numbers.with_u(first.restitution, first.u_phase),
            numbers.with_u(effective.value, effective.u), numbers.plain(first.scatter, 2),
        )  # fmt: skip
        for place, row in enumerate(source.numbers):
            typed_number = f"{row.name} = {numbers.with_u(row.value, row.u or None, row.unit)}"
            rows.append((source.name, typed_number, *(cells if place == 0 else ("",) * len(cells))))
        if not source.numbers:
            rows.append((source.name, "–", *cells))
    columns = (
        Column("Source", text=True, nowrap=True), Column("Type in ± u", text=True),
        Column("First impact ± u"), Column("Mean of all ± u"), Column("Scatter"),
    )  # fmt: skip
    step_ms = 1e3 * record.valid.engine_step_s
    note = (
        f"For a fixed step of {numbers.plain(step_ms)} ms alone. Scatter: how far a single impact"
        f" may be off. With all digits: simcompare export {run.record.scenario_asked} --fit …"
        " --contact-values."
    )
    note = " ".join((*engine_words.one_number(record), note))
    return Table("What to type into your own loop", columns, (Group("", tuple(rows)),), note)


def contacts(run: Run) -> Table | None:
    """How deep and how long each engine's first contact is."""
    rows = []
    for source in fits.engines(run):
        one = source.contact_of_first_impact
        sizes = (one.penetration_m, one.contact_s, one.delay_s)
        rows.append((source.name, *map(_milli, sizes)))
    columns = (Column("Source", text=True, nowrap=True), Column("Depth (mm)"),
               Column("Contact (ms)"), Column("Next impact late by (ms)"))  # fmt: skip
    note = "No restitution makes up for the time that a contact takes."
    return Table("The first contact", columns, (Group("", tuple(rows)),), note) if rows else None


def impacts(run: Run) -> Table | None:
    """Each recorded impact in each engine."""
    groups = []
    for source in fits.engines(run):
        rows = tuple(
            (_of(run, row), numbers.plain(row.speed_m_s, 3),
             numbers.plain(row.closed_form, 6),
             numbers.with_u(row.restitution, row.u_phase),
             numbers.plain(row.scatter, 2), numbers.plain(100 * row.deviation, 2),
             numbers.with_u(1e3 * row.late_s, 1e3 * row.scatter_s))
            for row in source.impacts
        )  # fmt: skip
        groups.append(Group(source.name, rows))
    if not groups:
        return None
    columns = (
        Column("Impact"), Column("Speed (m/s)"), Column("Closed form"), Column("Engine ± u"),
        Column("Scatter"), Column("Off by (%)"), Column("Late by ± scatter (ms)"),
    )  # fmt: skip
    note = "Late: the middle of the contact against the instant of the closed form."
    return Table("Impact by impact", columns, tuple(groups), note, folded=True)


def _of(run: Run, row: Impact) -> str:
    several = len(fits.bounces(run).measured) > 1
    return f"{row.number}" + (f" of drop {row.drop}" if several else "")


def _milli(value: float | None) -> str:
    return numbers.plain(None if value is None else 1e3 * value, 3)


def impacts_figure(run: Run) -> Figure | None:
    """How far each impact is from the closed form: restitution, and time."""
    sources = fits.engines(run)
    if not sources:
        return None
    off, late = [], []
    for i, source in enumerate(sources):
        rows = [row for row in source.impacts if row.drop == 1]
        x = np.array([row.number for row in rows]) + spread(i, len(sources), 0.3)
        style = style_of(source.name)
        part = np.array([100 * row.deviation for row in rows])
        bars = np.array([100 * row.scatter / row.closed_form for row in rows])
        off.append(Series(source.name, x, part, style, bars, points=True, line=False))
        delay = np.array([1e3 * row.late_s for row in rows])
        scatter = np.array([1e3 * row.scatter_s for row in rows])
        late.append(Series(source.name, x, delay, style, scatter, points=True, line=False))
    most = max(len(one.x) for one in off)
    zero = Series("closed form", np.array([1.0, most]), np.zeros(2), _ZERO)
    panels = (
        Panel("Restitution", "number of the impact", "off by (%)", (zero, *off), integer_x=True),
        Panel("Time", "number of the impact", "late by (ms)", (zero, *late), integer_x=True),
    )
    caption = (
        "Each engine in its plain loop beside the closed form; bars: scatter over the phases of the"
        " step. The first impact was tuned, the others follow. Impacts are late by the contacts"
        " before them."
    )
    if len(fits.bounces(run).measured) > 1:
        caption += " The first drop."
    return Figure("impacts", "Each impact in a plain loop", caption, panels)


def heights(run: Run) -> Table | None:
    """Rebound heights of held-out drops, measured and predicted."""
    groups = []
    for drop in fits.bounces(run).holdout.drops:
        rows = []
        for row in drop.heights:
            measured = numbers.with_u(row.measured, row.u_measured)
            own: list[tuple[str, PredictedHeight]] = [(CLOSED, row)]
            own += [
                (name, height)
                for name, engine in drop.engines.items()
                for height in engine.heights if height.number == row.number
            ]  # fmt: skip
            for name, one in own:
                score = None if one.e_n is None else abs(one.e_n)
                rows.append((str(row.number), name, measured,
                             numbers.with_u(one.predicted, one.u_predicted),
                             numbers.plain(score, 3)))  # fmt: skip
        if rows:
            groups.append(Group(validations.short(str(drop.source)), tuple(rows)))
    if not groups:
        return None
    columns = (Column("Bounce"), Column("Source", text=True), Column("Measured ± u (m)"),
               Column("Predicted ± u (m)"), Column("|E_n|"))  # fmt: skip
    note = "Without measured heights they are g·T²/8 of the flights between impacts."
    return Table("Rebound heights of held-out drops", columns, tuple(groups), note, folded=True)
