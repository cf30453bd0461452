"""Figures of a fit: what is left, parameters and effective values, restitution against speed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.reports.fit import fits
from simcompare.reports.fit.fits import CLOSED, RESTITUTION
from simcompare.reports.render.figures import Figure, Panel, Series, Span, fitted_range, spread
from simcompare.reports.render.styles import MEASURED_STYLE, Style, style_of
from simcompare.reports.run import runs
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_engines import BouncesEngine
from simcompare.results.records.fit_forms import Law, Residuals, Unknown
from simcompare.results.records.fit_parts import EngineParameter
from simcompare.results.run import Run

#: what is drawn of residuals: kind, name of the figure, quantity, unit, axis
_KINDS = (
    ("times", "Impact times", "s", "number of the impact"),
    ("intervals", "Time intervals", "s", "number of the impact before"),
    ("heights", "Rebound heights", "m", "number of the bounce, 0 is the drop"),
    ("track", "Heights in the video", "m", "time (s)"),
)
_CLOSED = Style("#7F7F7F", "solid", "star")
_EXPECTED = Style("#7F7F7F", "dot", width=2.0)
_STATED, _WIDENED = Style("#555555"), Style("#BDBDBD")
_PARAMETER, _EFFECTIVE = Style("#0072B2"), Style("#D55E00", marker="diamond", hollow=True)
_INTERVAL = Style("#0072B2", width=2.0)
#: rows that a figure of usual height holds
_ROWS = 7
#: scatter above which a second band shows what the fit made of the uncertainties
_WIDER = 1.2


def residual_figures(run: Run) -> list[Figure]:
    """Measured less simulated, for every kind of number that was measured."""
    found = []
    for kind, title, unit, axis in _KINDS:
        if any(row.kind == kind for row in fits.bounces(run).residuals):
            found.append(_residual_figure(run, kind, title, unit, axis))
    return found


def _residual_figure(run: Run, kind: str, title: str, unit: str, axis: str) -> Figure:
    rows = [row for row in fits.bounces(run).residuals if row.kind == kind]
    wide = _widening(run) if all(row.judged for row in rows) else 1.0
    sizes = [v for row in rows for v in row.residuals] + [wide * u for row in rows for u in row.u]
    factor, small = phrases.people_unit(unit, sizes)
    drawn = set(fits.drawn_drops(run))
    panels = tuple(
        Panel(
            fits.drop_title(run, row.drop), axis, f"measured − simulated ({small})",
            tuple(_residual_series(run, row, factor, wide)), integer_x=kind != "track",
        )
        for row in rows if row.drop in drawn
    )  # fmt: skip
    caption = f"Measured minus simulated, with the fitted parameters.{_band_words(rows)}"
    if wide > 1 and any(row.stated for row in rows):
        caption += f" The wide band: the data scatter {wide:.1f} times as much as stated."
    if not all(row.judged for row in rows):
        caption += " They are drawn from the arcs of the video; the fit judged its samples."
    caption += fits.drawn_words(run)
    head = f"{title}, measured minus simulated"
    return Figure(f"left-{kind}", head, caption, panels, share_y=True)


def _band_words(rows: Sequence[Residuals]) -> str:
    if all(row.stated for row in rows):
        return " Band: twice the stated standard uncertainty."
    return " Band: twice the standard uncertainty, from the scatter, for none is stated."


def _widening(run: Run) -> float:
    """By how much the fit widened stated uncertainties."""
    factor = math.sqrt(fits.bounces(run).closed_form.s2)
    stated = any(row.stated for row in fits.bounces(run).residuals)
    return factor if stated and factor > _WIDER else 1.0


def _residual_series(run: Run, row: Residuals, factor: float, wide: float) -> list[Series]:
    x, u = np.array(row.at, dtype=float), factor * 2 * np.array(row.u)
    zero = np.zeros(len(x))
    found = []
    if wide > 1 and row.stated:
        found.append(Series("± 2u, widened", x, zero, _WIDENED, wide * u, line=False, shaded=True))
    found.append(Series("± 2u of the measurement", x, zero, _STATED, u, line=False, shaded=True))
    is_track = row.kind == "track"
    left = factor * np.array(row.residuals)
    found.append(Series(CLOSED, x, left, _CLOSED, points=True, line=not is_track))
    sources = fits.engines(run)
    for i, source in enumerate(sources):
        for own in source.residuals:
            if (own.drop, own.kind) == (row.drop, row.kind):
                shift = 0.0 if is_track else spread(i, len(sources), 0.3)
                y, style = factor * np.array(own.residuals), style_of(source.name)
                found.append(Series(source.name, x + shift, y, style, points=True, line=False))
    return found


def parameter_figure(run: Run) -> Figure | None:
    """Parameters and effective values of all engines beside the closed form."""
    sources = fits.engines(run)
    closed = fits.bounces(run).closed_form.found
    if not sources:
        return None
    if RESTITUTION not in closed:
        return None
    panels = (_parameter_panel(RESTITUTION, closed[RESTITUTION], sources),)
    caption = (
        "Filled: what the engine must be given, with its 95 % interval. Hollow: the restitution"
        " that it then shows, with twice its standard uncertainty."
    )
    rows = max(len(sources) + 1, 4)
    return Figure("parameters", "Parameters and what they produce", caption, panels, share_y=True,
                  height=round(max(0.75, rows / _ROWS), 2))  # fmt: skip


def _parameter_panel(name: str, closed: Unknown, sources: Sequence[BouncesEngine]) -> Panel:
    rows = [closed, *(source.parameters.get(name) for source in sources)]
    known = [(i, row) for i, row in enumerate(rows) if row is not None and row.value is not None]
    shift = 0.14 if name == RESTITUTION else 0.0
    x = np.array([row.value for _, row in known])
    y = np.array([i - (shift if i else 0.0) for i, _ in known])
    ends = [_finite_ends(row) for _, row in known]
    bars = np.array([v for low, high in ends for v in (low, high, math.nan)])
    series = [
        Series("95 % interval", bars, np.repeat(y, 3) + 0 * bars, _INTERVAL),
        Series("parameter", x, y, _PARAMETER, points=True, line=False),
    ]
    if name == RESTITUTION:
        shown = [(i, s.effective[name]) for i, s in enumerate(sources, 1) if s.effective]
        series.append(
            Series("effective value ± 2u", np.array([row.value for _, row in shown]),
                   np.array([i + shift for i, _ in shown]), _EFFECTIVE,
                   np.array([2 * row.u for _, row in shown]), points=True, line=False)
        )  # fmt: skip
    low, high = _finite_ends(closed)
    ticks = (CLOSED, *(source.name for source in sources))
    return Panel(fits.title(name), fits.with_unit(name), "", tuple(series),
                 spans=(Span(low, high, "closed form, 95 %"),), y_ticks=ticks,
                 x_limits=_around(series))  # fmt: skip


def _finite_ends(row: Unknown | EngineParameter) -> tuple[float, float]:
    """Ends of the interval; one that is open is drawn only as far as the value."""
    low, high = fits.interval(row)
    value = math.nan if row.value is None else row.value
    return (low if math.isfinite(low) else value), (high if math.isfinite(high) else value)


def _around(series: Sequence[Series]) -> tuple[float, float]:
    """Limits in which all points and the bars that lie are seen."""
    parts = []
    for one in series:
        u = np.zeros(len(one.x)) if one.u is None else one.u
        parts += [one.x - u, one.x + u]
    values = np.concatenate(parts)
    values = values[np.isfinite(values)]
    low, high = float(values.min()), float(values.max())
    margin = 0.08 * (high - low) or 1e-6 * max(abs(high), 1.0)
    return low - margin, high + margin


def speed_figure(run: Run) -> Figure | None:
    """Restitution of every bounce against the speed of its impact."""
    found = fits.bounces(run)
    law = found.law
    speeds = np.array(law.speed_m_s)
    line = Series("closed form ± 2u", speeds, np.array(law.value), _CLOSED,
                  2 * np.array(law.u), shaded=True)  # fmt: skip
    series = [line]
    for row in found.ratios:
        x = _speeds(law, row.drop, row.numbers)
        series.append(Series("closed form's ratio", x, np.array(row.expected), _EXPECTED))
        u = np.array([math.nan if v is None else 2 * v for v in row.u])
        series.append(Series("measured ratio ± 2u", x, np.array(row.values), MEASURED_STYLE, u,
                             points=True, line=False))  # fmt: skip
    for source in fits.engines(run):
        for number, seen in enumerate(source.shown, start=1):
            y = np.array(seen.restitution)
            x = _speeds(law, number, range(1, len(y) + 1))
            series.append(Series(source.name, x, y, style_of(source.name), points=True,
                                 line=False))  # fmt: skip
    bare = tuple(Series(s.label, s.x, s.y, s.style) for s in series)
    panel = Panel("", "speed at impact" + runs.unit_words("m/s"), "restitution", tuple(series),
                  y_range=fitted_range((line, *bare), ()))  # fmt: skip
    return Figure("speed", "Restitution of every bounce", _speed_caption(run), (panel,))


def _speed_caption(run: Run) -> str:
    said = "Speeds are those of the closed form."
    hows = {row.how for row in fits.bounces(run).ratios}
    if "flight times" in hows:
        said += (
            " A measured point is the ratio of two neighbouring flight times; drag makes it smaller"
            " than the restitution, from the full line down to the dotted one."
        )
    if "heights" in hows:
        said += " A measured point is the root of the ratio of two neighbouring heights."
    return said


def _speeds(law: Law, drop: int, numbers: Sequence[int]) -> Array:
    every: Array = np.array(law.impact_speed_m_s[drop - 1], dtype=float)
    chosen: Array = every[np.array(numbers, dtype=int) - 1]
    return chosen
