"""Figures and tables of a fit to signals over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simcompare.model.resampling import interpolated
from simcompare.model.trajectory import Trajectory
from simcompare.reports.fit import fits
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Band, Figure, Panel, Series
from simcompare.reports.render.styles import style_of
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.run import runs
from simcompare.reports.validation import validations
from simcompare.reports.validation.waveforms import with_gaps
from simcompare.results.records.fit_waveforms import FitSegment, JudgedValue
from simcompare.results.run import Run

#: how fitted engines are stored, and how many segments are drawn beside each other
FITTED, MAX_DRAWN = "fitted", 3


def residual_figures(run: Run) -> list[Figure]:
    """Simulated minus measured over time: the fitted segments, and those that were held out."""
    found = fits.signals(run)
    count = len(found.measured)
    cases = [*found.measured, *found.held_out]
    kinds = (("fitted", range(count)), ("held out", range(count, len(cases))))
    figures = []
    for probe in found.probes:
        for kind, numbers_ in kinds:
            panels = [_panel(run, probe, i, cases[i]) for i in list(numbers_)[:MAX_DRAWN]]
            drawn = tuple(panel for panel in panels if panel is not None)
            if drawn:
                figures.append(_figure(run, probe, kind, drawn))
    return figures


def _figure(run: Run, probe: str, kind: str, panels: tuple[Panel, ...]) -> Figure:
    caption = (
        "Grey band: noise of a single sample, twice its standard uncertainty. A pattern that all"
        " engines share is not the error of an engine but of the model or of the measurement."
    )
    title = f"{_label(run, probe)}: what is left of the segments that were {kind}"
    return Figure(f"left-{probe}-{kind.replace(' ', '-')}", title, caption, panels)


def _panel(run: Run, probe: str, number: int, case: FitSegment) -> Panel | None:
    measured = validations.stored(run, "measured", "", number)
    if measured is None or probe not in measured.signals:
        return None
    lines = []
    for source in fits.wave_engines(run):
        shown = validations.stored(run, source.name, FITTED, number)
        if shown is not None:
            lines.append(_line(source.name, shown, measured, probe))
    if not lines:
        return None
    u = float(case.probes[probe].u)
    largest = max(float(np.nanmax(np.abs(line.y), initial=0.0)) for line in lines)
    reach = 1.1 * max(largest, 2.5 * u) or 1.0
    unit = runs.unit_words(str(run.record.probes[probe].unit))
    return Panel(
        case.stream, "time (s)", f"simulated − measured{unit}", tuple(lines),
        (Band(-2 * u, 2 * u, "noise of a sample ± 2u", 0.0),) if u else (), y_range=(-reach, reach),
    )  # fmt: skip


def _line(engine: str, shown: Trajectory, measured: Trajectory, probe: str) -> Series:
    left = interpolated(shown.time_s, shown.signals[probe], measured.time_s)
    thin = replace(style_of(engine), width=1.2)
    return Series(engine, *with_gaps(measured.time_s, left - measured.signals[probe]), thin)


def _label(run: Run, probe: str) -> str:
    return str(run.record.probes[probe].label)


def holdout(run: Run) -> Table | None:
    """Values of the segments that were held out, and how well engines predict them."""
    rows = fits.signals(run).holdout.streams
    groups = []
    for segment in rows:
        cells: list[tuple[str, ...]] = []
        for i, value in enumerate(segment.values):
            cells.append((value.measure, "measured", _number(value.measured),
                          _number(value.u_data, 2), "–"))  # fmt: skip
            for engine, own in segment.engines.items():
                cells += _predicted(engine, own.values[i : i + 1])
        groups.append(Group(segment.stream, tuple(cells)))
    if not groups:
        return None
    columns = (Column("Value", text=True), Column("Source", text=True), Column("Found"),
               Column("u"), Column("E_n"))  # fmt: skip
    note = "E_n is the difference from the measured value over both expanded uncertainties (k = 2)."
    return Table("Values of the segments that were held out", columns, tuple(groups), note)


def _predicted(engine: str, own: Sequence[JudgedValue]) -> list[tuple[str, ...]]:
    return [
        (row.measure, engine, _number(row.simulated), _number(row.u_val, 2),
         "–" if row.e_n is None else f"{row.e_n:+.2f}".replace("-", "−"))
        for row in own
    ]  # fmt: skip


def _number(value: float | None, digits: int = 5) -> str:
    return "–" if value is None else numbers.plain(value, digits)


def effective(run: Run) -> Table:
    """What each engine shows with its own parameters, in the segments that were fitted."""
    groups = []
    names = dict.fromkeys(n for row in fits.wave_engines(run) for n in row.effective)
    for name in names:
        rows = []
        for source in fits.wave_engines(run):
            row = source.effective.get(name)
            cells = (None, None, None) if row is None else (row.value, row.u, row.measured)
            shown, u, measured = cells
            rows.append((source.name, _number(shown), _number(u, 2), _number(measured)))
        groups.append(Group(fits.with_unit(name), tuple(rows)))
    columns = (Column("Source", text=True), Column("Shown"), Column("u"), Column("Measured"))
    note = (
        "A parameter is shown here as the reference would need it to show the same; of the"
        " parameter that is typed in, only this can be compared between engines."
    )
    return Table("What engines then show", columns, tuple(groups), note, folded=True)


def valid(run: Run) -> dict[str, str]:
    """Where the fit holds."""
    found = fits.signals(run).valid
    facts = {"step": f"{found.step_s:g} s", "longest segment": f"{found.duration_s:.4g} s"}
    for probe, (low, high) in found.ranges.items():
        unit = run.record.probes[probe].unit
        facts[_label(run, probe)] = f"{low:.4g} to {high:.4g} {unit}"
    return facts
