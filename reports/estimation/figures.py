"""Pictures of an estimation: the state with its band, its error, and the NEES over time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from simcompare import units
from simcompare.reports.estimation import chips, drift, units_of
from simcompare.reports.estimation.words import lead_state
from simcompare.reports.render.figures import Band, Figure, Panel, Series, fitted_range
from simcompare.reports.render.styles import TRUTH_STYLE, Style, numbered_style, style_of
from simcompare.results.records.estimation import Curve, Estimation, SourceEstimate

#: the filter is blue; what sensors say alone comes in other colours, as points where it scatters
_BEST, _SMOOTH, _ALONE = 0, 2, 1
#: standard uncertainties in a band of about 95 %
_BAND = 2.0
_TIME = "Time (s)"


def figures(result: Estimation) -> list[Figure]:
    """All pictures, the one that answers first."""
    if not result.done:
        return []
    first = result.done[0]
    if drift.known(result):
        return [drift.figure(result, drift.known(result)[0])]
    path = [_path(result, first)] if {"x_m", "y_m"} <= set(result.labels) else []
    asked = [one for one in (chips.figure(result),) if one is not None]
    return [*asked, lead(result, first), *path, *_over_time(result)]


def lead(result: Estimation, source: SourceEstimate) -> Figure:
    """Truth, sensors alone and filter with its band; and the error of the filter in its band."""
    state = lead_state(result)
    best = source.ways[0]
    rows = [one for one in source.curves if one.state == state]
    unit = units.symbol(units.unit_of(state))
    label = result.labels[state]
    told = tuple(_told(rows, best))
    # the band at the start, where nothing is known yet, would flatten all else
    y_range = fitted_range(tuple(replace(one, u=None) for one in told), ())
    panels = [Panel(label, _TIME, f"{label} ({unit})", told, y_range=y_range)]
    error = _error_panel(rows, best, state)
    caption = (
        f"{_whose(result, source)}. Bands are ± {_BAND:g} standard uncertainties"
        " as the filter states them: about 95 % of its errors should lie within."
    )
    title = f"{label} as the sensors tell it"
    return Figure("estimate", title, caption, (*panels, *([error] if error else [])))


def _told(rows: list[Curve], best: str) -> list[Series]:
    """Truth at the bottom, then what sensors say alone, and the filter on top."""
    found = []
    truth = next((one for one in rows if one.way == best and one.truth is not None), None)
    if truth is not None and truth.truth is not None:
        time, values = np.array(truth.time_s), np.array(truth.truth)
        found.append(Series("truth", time, values, TRUTH_STYLE))
    alone = [one for one in rows if one.way not in (best, "smoothed")]
    for number, one in enumerate(alone):
        style = replace(numbered_style(_ALONE + 2 * number), width=1.5)
        x, y = np.array(one.time_s), np.array(one.values)
        scatters = one.u is not None
        found.append(Series(one.way, x, y, style, points=scatters, line=not scatters))
    for way, number in (("smoothed", _SMOOTH), (best, _BEST)):
        found += [
            _banded(one, numbered_style(number), shaded=way == best)
            for one in rows
            if one.way == way
        ]
    return found


def _banded(curve: Curve, style: Style, *, shaded: bool) -> Series:
    u = _BAND * np.array(curve.u) if shaded and curve.u is not None else None
    x, y = np.array(curve.time_s), np.array(curve.values)
    return Series(curve.way, x, y, style, u, shaded=shaded)


def _error_panel(rows: list[Curve], best: str, state: str) -> Panel | None:
    """Error of the filter and of the smoother about 0, with the filter's band."""
    series = []
    own = next((one for one in rows if one.way == best), None)
    if own is None or own.truth is None:
        return None
    errors = np.array(own.values) - np.array(own.truth)
    factor, unit = units_of.scale(state, [float(np.nanmax(np.abs(errors)))])
    x = np.array(own.time_s)
    if own.u is not None:
        band = _BAND * factor * np.array(own.u)
        style = Style("#9EC3E6")
        series.append(Series(f"± {_BAND:g} u", x, 0 * x, style, band, line=False, shaded=True))
    smooth = next((one for one in rows if one.way == "smoothed" and one.truth is not None), None)
    if smooth is not None and smooth.truth is not None:
        y = factor * (np.array(smooth.values) - np.array(smooth.truth))
        series.append(Series("smoothed", np.array(smooth.time_s), y, numbered_style(_SMOOTH)))
    series.append(Series(best, x, factor * errors, numbered_style(_BEST)))
    limit = 2.5 * float(np.nanmax(np.abs(factor * errors[len(errors) // 10 :])) or 1.0)
    u_late = factor * float(np.nanmedian(np.array(own.u))) if own.u is not None else 0.0
    limit = max(limit, 3 * u_late)
    y_range = (-limit, limit)
    return Panel("Its error", _TIME, f"Error ({unit})", tuple(series), y_range=y_range)


def _path(result: Estimation, source: SourceEstimate) -> Figure:
    caption = f"{_whose(result, source)}."
    title = "The path as the sensors tell it"
    return Figure("path", title, caption, (drift.above(source),))


def _whose(result: Estimation, source: SourceEstimate) -> str:
    """Whose motion is drawn; that of an engine is measured many times."""
    return source.source if result.recording else f"{source.source}, first draw of the sensors"


def _mean_of(runs: int) -> str:
    return f"Mean of {runs} draws." if runs > 1 else "One run, whose neighbouring errors are alike."


def _over_time(result: Estimation) -> list[Figure]:
    """NEES of each source over time, with the band in which it should be."""
    known = [one for one in result.done if one.nees is not None]
    if not known:
        return []
    series = []
    for one in known:
        style = numbered_style(0) if result.recording else style_of(one.source)
        time, values = (np.array(row) for row in one.nees_over_time)
        series.append(Series(one.source, time, values, style))
    verdict = known[0].nees
    assert verdict is not None
    band = Band(verdict.low, verdict.high, "95 % expected", float(verdict.degrees_of_freedom))
    high = max(float(np.nanmax(row.y)) for row in series)
    panel = Panel("", _TIME, "NEES", tuple(series), (band,), log_y=high > 10 * verdict.high)
    caption = (
        f"{_mean_of(verdict.runs)} Above the band the filter errs more than it says, below it less."
    )
    return [Figure("nees", "Does the filter know its error?", caption, (panel,))]
