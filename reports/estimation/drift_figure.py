"""Dead reckoning seen from above, and how its distance from the truth grows."""

from __future__ import annotations

import numpy as np

from simcompare.reports.estimation import units_of
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import TRUTH_STYLE, Style, numbered_style
from simcompare.results.records.estimation import Curve, Estimation, SourceEstimate

#: standard uncertainties in a band of about 95 %
_BAND = 2.0


def figure(result: Estimation, source: SourceEstimate) -> Figure:
    """Both panels, of one source.

    Args:
        result: the estimation.
        source: one of which the end was told.
    """
    panels = (above(source), _distance(source))
    draw = ", first draw" if result.draws > 1 else ""
    caption = (
        f"{source.source}{draw}. The dashed line holds the end with 95 %, as what is not known of"
        f" wheels, track and start and the counting say; the band is {_BAND:g} u of the distance."
    )
    return Figure("path", "Where odometry believes the robot, and where it is", caption, panels)


def above(source: SourceEstimate) -> Panel:
    """The place from above: the truth, and each way of telling it."""
    series = []
    for number, way in enumerate(source.ways):
        x, y = source.curve_of(way, "x_m"), source.curve_of(way, "y_m")
        if x is None or y is None:
            continue
        if number == 0 and x.truth is not None and y.truth is not None:
            series.append(Series("truth", np.array(x.truth), np.array(y.truth), TRUTH_STYLE))
        series.append(Series(way, np.array(x.values), np.array(y.values), numbered_style(number)))
    return Panel("Seen from above", "x (m)", "y (m)", tuple(series), is_map=True)


def _distance(source: SourceEstimate) -> Panel:
    curve = source.curve_of(source.ways[0], "drift_m")
    assert curve is not None
    factor, unit = units_of.scale("drift_m", [float(np.nanmax(np.array(curve.values)))])
    time, values = np.array(curve.time_s), factor * np.array(curve.values)
    series = (*_band(curve, time, factor), Series(curve.way, time, values, numbered_style(0)))
    label = f"Distance from the true place ({unit})"
    return Panel("Drift", "Time (s)", label, series, y_range=_range(curve, factor))


def _band(curve: Curve, time: np.ndarray, factor: float) -> tuple[Series, ...]:
    """From 0 to so many standard uncertainties: a distance has no sign."""
    if curve.u is None:
        return ()
    half = _BAND * factor * np.array(curve.u) / 2
    style = Style("#9EC3E6")
    return (Series(f"{_BAND:g} u", time, half, style, half, line=False, shaded=True),)


def _range(curve: Curve, factor: float) -> tuple[float, float]:
    u = 0.0 if curve.u is None else _BAND * float(np.nanmax(np.array(curve.u)))
    top = factor * max(u, float(np.nanmax(np.array(curve.values))))
    return 0.0, 1.05 * top if top > 0 else 1.0
