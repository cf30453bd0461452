"""Where dead reckoning ends: how far from the truth, and whether its uncertainty explains that."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from simcompare.reports.estimation import units_of
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import TRUTH_STYLE, Style, numbered_style
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results.records.estimation import Curve, Estimation, SourceEstimate

#: an error of so many standard uncertainties is still explained by them (about 95 %)
_EXPLAINED = 2.0
#: what is told of an end, and its heading in the table
_COLUMNS = {"end_drift": "Off", "end_along": "Along", "end_across": "Across", "end_turn": "Turned"}
#: standard uncertainties in a band of about 95 %
_BAND = 2.0


def known(result: Estimation) -> list[SourceEstimate]:
    """Sources of which the end was told."""
    return [one for one in result.done if {"end_drift", "path_length"} <= set(one.numbers)]


def sentences(result: Estimation) -> Iterator[str]:
    """How far, on how long a way, how sure, and whether that is as it must be."""
    rows = known(result)
    if not rows:
        return
    ends = [one.numbers["end_drift"] for one in rows]
    ways = [one.numbers["path_length"].value for one in rows]
    factor, unit = units_of.scale("drift_m", [end.value for end in ends])
    u = factor * max(end.u or 0.0 for end in ends)
    off = _to_place([factor * end.value for end in ends], u)
    drifts = [one.numbers["drift_per_metre"] for one in rows if "drift_per_metre" in one.numbers]
    each = _to_place(
        [1e3 * d.value for d in drifts], 1e3 * max((d.u or 0.0 for d in drifts), default=0)
    )
    yield (
        f"After {_span(ways, 3)} m odometry ends {off} {unit} from the robot"
        f" (u = {numbers.plain(u, 2)} {unit}), {each} mm on each metre."
    )
    shares = [end.value / end.u for end in ends if end.u]
    if len(shares) < len(ends):
        return
    explains = max(shares) <= _EXPLAINED
    yield (
        f"That is {_span(shares, 2)} standard uncertainties: what is not known of wheels, track,"
        f" start and counting {'explains' if explains else 'does not explain'} it."
    )


def table(result: Estimation) -> Table:
    """The end of each source: off by how much, along, across and turned, each with its u."""
    factor, unit = units_of.scale("drift_m", [o.numbers["end_drift"].value for o in known(result)])
    words = [Column("Recording" if result.recording else "Engine", text=True), Column("Way (m)")]
    told = [key for key in _COLUMNS if any(key in one.numbers for one in known(result))]
    columns = [Column(f"{_COLUMNS[key]} ± u ({_unit(key, unit)})") for key in told]
    rows = [
        (
            one.source,
            numbers.plain(one.numbers["path_length"].value, 4),
            *(_with_u(one, key, factor) for key in told),
        )
        for one in known(result)
    ]
    title = "Where odometry ends, less where the robot ends"
    return Table(title, (*words, *columns), (Group("", tuple(rows)),), engines=not result.recording)


def _unit(key: str, unit: str) -> str:
    return "mrad" if key == "end_turn" else unit


def _with_u(source: SourceEstimate, key: str, factor: float) -> str:
    found = source.numbers.get(key)
    if found is None:
        return "–"
    size = 1e3 if key == "end_turn" else factor
    if not found.u:
        return numbers.plain(size * found.value, 3)
    return numbers.with_u(size * found.value, size * found.u)


def _to_place(values: Sequence[float], u: float) -> str:
    """The least and the largest, to the place of the second digit of their uncertainty."""
    if not u > 0:
        return _span(values, 3)
    places = max(0, 1 - math.floor(math.log10(u)))
    low, high = (f"{one:.{places}f}" for one in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def _span(values: Sequence[float], digits: int) -> str:
    low, high = (numbers.plain(one, digits) for one in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


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
