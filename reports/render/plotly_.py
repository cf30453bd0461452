"""Figures as plotly's JSON, written without the plotly package; its script is inlined once."""

from __future__ import annotations

import functools
import html
import importlib.util
import json
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.errors import OutputError
from simcompare.model.trajectory import Array
from simcompare.reports.render.decimation import decimated
from simcompare.reports.render.figures import (
    MATRIX_COLOURS,
    Band,
    Bars,
    Figure,
    Matrix,
    Note,
    Panel,
    Series,
    Span,
)

FONT_PX = 16
#: space between panels, as part of the width
_GAP, _SHARED_GAP = 0.12, 0.03
#: height of the legend above the panels, as part of a plot of usual height
_LEGEND_UP = 0.13
#: numbers along the x axes of all panels together
_TICKS = 14
#: digits that are kept of a coordinate; a screen shows fewer
_DIGITS = 7
#: whole numbers; plotly's own are small digits without their power beside large powers of ten
_LOG_TICKS = "~g"
_INK, _GRID = "#222222", "#E3E3E3"
_BAND_FILL, _BAND_LINE = "rgba(0, 0, 0, 0.09)", "#555555"


@functools.cache
def script() -> str:
    """Plotly's JavaScript, from the installed package but without importing it.

    Raises:
        OutputError: the package is not installed.
    """
    spec = importlib.util.find_spec("plotly")
    for folder in spec.submodule_search_locations or () if spec else ():
        path = Path(folder) / "package_data" / "plotly.min.js"
        if path.is_file():
            # inside of a script element only this sequence could end it early
            return path.read_text(encoding="utf-8").replace("</script", "<\\/script")
    raise OutputError("plotly's script plotly.min.js is not installed; cure: pip install plotly")


def embedded(figure: Figure) -> str:
    """A figure as JSON that can stand inside of a script element."""
    text = json.dumps(as_dict(figure), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def as_dict(figure: Figure) -> dict[str, Any]:
    """A figure as plotly's ``{"data": …, "layout": …}``; numbers that are not finite are null."""
    layout: dict[str, Any] = {
        "font": {"size": FONT_PX, "color": _INK},
        "paper_bgcolor": "#ffffff",
        "plot_bgcolor": "#ffffff",
        "separators": ".",  # no comma between thousands
        "margin": {"l": 84, "r": 16, "t": 96, "b": 64},
        "legend": {
            "orientation": "h",
            "x": 0,
            "y": round(1 + _LEGEND_UP / figure.height, 4),
            "yanchor": "bottom",
            "font": {"size": FONT_PX},
        },
        "hoverlabel": {"font": {"size": FONT_PX - 2}},
        "annotations": [],
        "shapes": [],
        "barmode": "stack",
    }
    data: list[dict[str, Any]] = []
    most_ticks = max(4, _TICKS // max(len(figure.panels), 1))
    listed: set[str] = set()
    notes: list[dict[str, Any]] = []
    legend = figure.legend
    ranks = {label: rank for rank, label in enumerate(legend, start=1)}
    for i, (panel, domain) in enumerate(zip(figure.panels, _domains(figure), strict=True)):
        axis = "" if i == 0 else str(i + 1)
        shared = figure.share_y and i > 0
        layout[f"xaxis{axis}"] = _x_axis(panel, domain, axis, most_ticks)
        layout[f"yaxis{axis}"] = _y_axis(figure, panel, axis, shared)
        middle = (domain[0] + domain[1]) / 2
        layout["annotations"].append(_head(panel.title, middle))
        notes += [_note(note, axis) for note in panel.notes]
        for band in panel.bands:
            layout["shapes"] += _band(band, axis, band.label not in listed)
            listed.add(band.label)
        for span in panel.spans:
            layout["shapes"].append(_span(span, axis, span.label not in {*listed, ""}))
            listed.add(span.label)
        lying = panel.y_ticks is not None
        if panel.matrix is not None:
            data.append(_matrix(panel.matrix, axis))
        for bars in panel.bars:
            data.append(_bars(bars, axis, bars.label not in listed, lying))
            listed.add(bars.label)
        for series in panel.series:
            chosen = series is legend.get(series.label)
            rank = {"legendrank": ranks[series.label]}
            drawn = series.line or series.points
            if series.shaded:
                data.append(_shade(series, axis, listed=chosen and not drawn) | rank)
            if drawn:
                error = "error_x" if lying else "error_y"
                data.append(_trace(series, axis, chosen, error) | rank)
            if chosen:  # once, also where two panels show the same
                legend.pop(series.label)
    layout["annotations"] += notes  # behind the heads, which the page finds by their number
    return {"data": data, "layout": layout}


def _domains(figure: Figure) -> list[tuple[float, float]]:
    count = len(figure.panels)
    gap = (_SHARED_GAP if figure.share_y else _GAP) if count > 1 else 0.0
    free = 1 - gap * (count - 1)
    whole = sum(panel.weight for panel in figure.panels)
    found, start = [], 0.0
    for panel in figure.panels:
        end = start + free * panel.weight / whole
        found.append((start, min(end, 1.0)))
        start = end + gap
    return found


def _axis(label: str) -> dict[str, Any]:
    return {
        "title": {"text": _text(label), "standoff": 10},
        "gridcolor": _GRID,
        "linecolor": "#999999",
        "zeroline": False,
        "showline": True,
        "mirror": True,
        "ticks": "outside",
        "automargin": True,
        "exponentformat": "power",
    }


def _x_axis(
    panel: Panel, domain: tuple[float, float], axis: str, most_ticks: int
) -> dict[str, Any]:
    found = {**_axis(panel.x_label), "domain": list(domain), "anchor": f"y{axis}"}
    found |= {"tickangle": 0, "nticks": most_ticks}
    if panel.x_range is not None:
        found["range"] = list(panel.x_range)
        if panel.whole_x:
            found |= {"tick0": 0, "dtick": max(1, round((panel.x_range[1]) / 10))}
    if panel.log_x:
        found |= {"type": "log", "dtick": "D2", "tickformat": _LOG_TICKS}
        found["minor"] = {"dtick": "D1", "ticks": "outside"}
    if panel.x_ticks is not None:
        count = len(panel.x_ticks)
        found |= {
            "tickvals": list(range(count)),
            "ticktext": [
                _text(tick.replace("\n", " ") if panel.slanted else tick) for tick in panel.x_ticks
            ],
            "tickangle": -40 if panel.slanted else 0,
        }
    return found


def _y_axis(figure: Figure, panel: Panel, axis: str, shared: bool) -> dict[str, Any]:
    found = {**_axis("" if shared else panel.y_label), "anchor": f"x{axis}"}
    if panel.log_y:
        found |= {"type": "log", "dtick": 1, "tickformat": _LOG_TICKS}
    elif panel.y_ticks is not None:
        found |= {
            "tickvals": list(range(len(panel.y_ticks))),
            "ticktext": list(map(_text, panel.y_ticks)),
            "showgrid": False,
        }
    elif figure.plain_y(panel):
        found["exponentformat"] = "none"
    y_range = figure.y_range(panel)
    if y_range is not None:
        low, high = np.log10(y_range) if panel.log_y else y_range
        found["range"] = [float(low), float(high)]
    if shared:
        found |= {"matches": "y", "showticklabels": False}
    return found


def _head(title: str, middle: float) -> dict[str, Any]:
    return {
        "text": f"<b>{_text(title)}</b>",
        "x": middle, "y": 1.02, "xref": "paper", "yref": "paper",
        "xanchor": "center", "yanchor": "bottom", "showarrow": False,
        "font": {"size": FONT_PX + 1},
    }  # fmt: skip


def _note(note: Note, axis: str) -> dict[str, Any]:
    ends = {"left": "right", "right": "left"}
    return {
        "text": _text(note.text), "x": note.x, "y": note.y, "xref": f"x{axis}", "yref": f"y{axis}",
        "xanchor": ends.get(note.side, "center"), "yanchor": "middle", "showarrow": False,
        "font": {"size": FONT_PX - 3, "color": note.colour},
    }  # fmt: skip


def _band(band: Band, axis: str, listed: bool) -> list[dict[str, Any]]:
    place = {"xref": f"x{axis} domain", "yref": f"y{axis}", "x0": 0, "x1": 1, "layer": "below"}
    fill = {
        "type": "rect", "y0": band.low, "y1": band.high, "fillcolor": _BAND_FILL,
        "line": {"width": 0}, "name": _text(band.label), "showlegend": listed,
    }  # fmt: skip
    shapes = [{**place, **fill}]
    if band.centre is not None:
        line = {"color": _BAND_LINE, "width": 1.5}
        shapes.append({**place, "type": "line", "y0": band.centre, "y1": band.centre, "line": line})
    return shapes


def _span(span: Span, axis: str, listed: bool) -> dict[str, Any]:
    instant = span.low == span.high
    line = {"color": _BAND_LINE, "width": 1.5, "dash": "dash"} if instant else {"width": 0}
    low, high = span.rows or (0, 1)
    return {
        "type": "line" if instant else "rect", "x0": span.low, "x1": span.high,
        "y0": low, "y1": high,
        "xref": f"x{axis}", "yref": f"y{axis}" if span.rows else f"y{axis} domain",
        "layer": "below", "line": line,
        "fillcolor": _BAND_FILL, "name": _text(span.label), "showlegend": listed,
    }  # fmt: skip


def _trace(series: Series, axis: str, listed: bool, error: str) -> dict[str, Any]:
    x, y = (series.x, series.y) if series.points else decimated(series.x, series.y)
    style = series.style
    modes = [name for name, on in (("lines", series.line), ("markers", series.points)) if on]
    found: dict[str, Any] = {
        "type": "scatter", "mode": "+".join(modes), "name": _text(series.label),
        "legendgroup": series.label, "showlegend": listed,
        "x": _numbers(x), "y": _numbers(y), "xaxis": f"x{axis}", "yaxis": f"y{axis}",
        "line": {"color": style.colour, "dash": style.dash, "width": style.width,
                 "simplify": False},
    }  # fmt: skip
    if series.points:
        symbol = f"{style.marker}-open" if style.hollow else style.marker
        found["marker"] = {
            "symbol": symbol,
            "size": 11,
            "color": style.colour,
            "line": {"width": 2 if style.hollow else 0, "color": style.colour},
        }
    if series.u is not None and not series.shaded:
        found[error] = {
            "type": "data", "array": _numbers(series.u), "color": style.colour,
            "thickness": 2, "width": 5,
        }  # fmt: skip
    return found


def _shade(series: Series, axis: str, *, listed: bool) -> dict[str, Any]:
    """The band of a line's uncertainty: there along the upper edge, back along the lower one."""
    assert series.u is not None
    x, low = decimated(series.x, series.y - series.u)
    x_high, high = decimated(series.x, series.y + series.u)
    return {
        "type": "scatter", "mode": "lines", "name": _text(series.label), "showlegend": listed,
        "legendgroup": series.label, "hoverinfo": "skip", "fill": "toself",
        "x": _numbers(np.concatenate((x, x_high[::-1]))),
        "y": _numbers(np.concatenate((low, high[::-1]))),
        "xaxis": f"x{axis}", "yaxis": f"y{axis}", "line": {"width": 0},
        "fillcolor": series.style.colour, "opacity": 0.25,
    }  # fmt: skip


def _matrix(matrix: Matrix, axis: str) -> dict[str, Any]:
    rows, columns = matrix.values.shape
    return {
        "type": "heatmap", "z": [_numbers(row) for row in matrix.values],
        "x": list(range(columns)), "y": list(range(rows)), "text": matrix.texts,
        "texttemplate": "%{text}", "textfont": {"color": _INK, "size": FONT_PX},
        "colorscale": [[i / 2, colour] for i, colour in enumerate(MATRIX_COLOURS)],
        "zmin": -1, "zmax": 1, "showscale": False, "xgap": 2, "ygap": 2, "hoverinfo": "text",
        "xaxis": f"x{axis}", "yaxis": f"y{axis}",
    }  # fmt: skip


def _bars(bars: Bars, axis: str, listed: bool, lying: bool) -> dict[str, Any]:
    places, lengths = list(range(len(bars.heights))), _numbers(bars.heights)
    found: dict[str, Any] = {
        "type": "bar", "name": _text(bars.label), "legendgroup": bars.label, "showlegend": listed,
        "x": lengths if lying else places, "y": places if lying else lengths,
        "orientation": "h" if lying else "v", "width": 0.7 if lying else 0.6,
        "xaxis": f"x{axis}", "yaxis": f"y{axis}",
        "marker": {"color": bars.colour, "pattern": {"shape": bars.hatch, "fgcolor": "#ffffff",
                                                     "fillmode": "overlay", "solidity": 0.25}},
    }  # fmt: skip
    if bars.texts:
        found |= {
            "text": [f"<b>{_text(text)}</b>" if text else "" for text in bars.texts],
            "textposition": "inside", "insidetextanchor": "middle", "textangle": 0,
            "insidetextfont": {"color": "#ffffff", "size": FONT_PX - 2},
        }  # fmt: skip
    return found


def _numbers(values: Array) -> list[float | None]:
    values = np.asarray(values, dtype=float)
    finite = np.isfinite(values) & (values != 0)
    powers = np.zeros(len(values))
    np.log10(np.abs(values), out=powers, where=finite)
    scale = 10.0 ** (_DIGITS - 1 - np.floor(powers))
    rounded = np.where(finite, np.round(values * scale) / scale, values)
    if np.isfinite(rounded).all():
        return list(rounded.tolist())
    return [value if np.isfinite(value) else None for value in rounded.tolist()]


def _text(text: str) -> str:
    """Plotly reads labels as a little HTML."""
    return html.escape(text, quote=False).replace("\n", "<br>")
