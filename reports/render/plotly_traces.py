"""What is drawn, as traces and shapes of plotly's JSON."""

from __future__ import annotations

import html
from typing import Any

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.reports.render.decimation import decimated
from simcompare.reports.render.figures import (
    Band,
    Bars,
    Matrix,
    Note,
    Series,
    Span,
)

#: plotly's figure format: objects whose keys are its own, see plotly.com/javascript/reference
Json = dict[str, Any]
FONT_PX = 16
INK = "#222222"
#: digits that are kept of a coordinate; a screen shows fewer
_DIGITS = 7
#: points of a line; no screen shows more of them side by side
_POINTS = 2400
_BAND_FILL, _BAND_LINE = "rgba(0, 0, 0, 0.09)", "#555555"


def note_of(note: Note, axis: str) -> Json:
    """Letters beside what is drawn."""
    return {
        "text": text_of(note.text), "x": note.x, "y": note.y,
        "xref": f"x{axis}", "yref": f"y{axis}",
        "xanchor": note.anchor, "yanchor": "middle", "showarrow": False,
        "font": {"size": FONT_PX - 3, "color": note.colour},
    }  # fmt: skip


def band_of(band: Band, axis: str, listed: bool) -> list[Json]:
    """A range of y, with the line in its middle where there is one."""
    place = {"xref": f"x{axis} domain", "yref": f"y{axis}", "x0": 0, "x1": 1, "layer": "below"}
    fill = {
        "type": "rect", "y0": band.low, "y1": band.high, "fillcolor": _BAND_FILL,
        "line": {"width": 0}, "name": text_of(band.label), "showlegend": listed,
    }  # fmt: skip
    shapes = [{**place, **fill}]
    if band.centre is not None:
        line = {"color": _BAND_LINE, "width": 1.5}
        shapes.append({**place, "type": "line", "y0": band.centre, "y1": band.centre, "line": line})
    return shapes


def span_of(span: Span, axis: str, listed: bool) -> Json:
    """A range of x, or a dashed line at one instant."""
    instant = span.low == span.high
    line = {"color": _BAND_LINE, "width": 1.5, "dash": "dash"} if instant else {"width": 0}
    low, high = span.rows or (0, 1)
    return {
        "type": "line" if instant else "rect", "x0": span.low, "x1": span.high,
        "y0": low, "y1": high,
        "xref": f"x{axis}", "yref": f"y{axis}" if span.rows else f"y{axis} domain",
        "layer": "below", "line": line,
        "fillcolor": _BAND_FILL, "name": text_of(span.label), "showlegend": listed,
    }  # fmt: skip


def trace_of(series: Series, axis: str, listed: bool, error: str) -> Json:
    """A line or points; ``error`` names the direction of their bars."""
    x, y = (series.x, series.y) if series.points else decimated(series.x, series.y, _POINTS)
    style = series.style
    modes = [name for name, on in (("lines", series.line), ("markers", series.points)) if on]
    trace: Json = {
        "type": "scatter", "mode": "+".join(modes), "name": text_of(series.label),
        "legendgroup": series.label, "showlegend": listed,
        "x": _numbers(x), "y": _numbers(y), "xaxis": f"x{axis}", "yaxis": f"y{axis}",
        "line": {"color": style.colour, "dash": style.dash, "width": style.width,
                 "simplify": False},
    }  # fmt: skip
    if series.points:
        symbol = f"{style.marker}-open" if style.hollow else style.marker
        trace["marker"] = {
            "symbol": symbol,
            "size": 11,
            "color": style.colour,
            "line": {"width": 2 if style.hollow else 0, "color": style.colour},
        }
    if series.u is not None and not series.shaded:
        trace[error] = {
            "type": "data", "array": _numbers(series.u), "color": style.colour,
            "thickness": 2, "width": 5,
        }  # fmt: skip
    return trace


def shade_of(series: Series, axis: str, *, listed: bool) -> Json:
    """The band of a line's uncertainty: there along the upper edge, back along the lower one."""
    assert series.u is not None
    x, low = decimated(series.x, series.y - series.u, _POINTS)
    x_high, high = decimated(series.x, series.y + series.u, _POINTS)
    return {
        "type": "scatter", "mode": "lines", "name": text_of(series.label), "showlegend": listed,
        "legendgroup": series.label, "hoverinfo": "skip", "fill": "toself",
        "x": _numbers(np.concatenate((x, x_high[::-1]))),
        "y": _numbers(np.concatenate((low, high[::-1]))),
        "xaxis": f"x{axis}", "yaxis": f"y{axis}", "line": {"width": 0},
        "fillcolor": series.style.colour, "opacity": 0.25,
    }  # fmt: skip


def matrix_of(matrix: Matrix, axis: str, *, small: bool) -> Json:
    """Cells with their numbers."""
    (rows, columns), last = matrix.values.shape, len(matrix.colours) - 1
    font = {"color": INK, "size": FONT_PX - 5 if small else FONT_PX}
    bar = {"title": {"text": text_of(matrix.bar), "side": "right"}, "thickness": 14, "len": 1.05}
    return {
        "type": "heatmap", "z": [_numbers(row) for row in matrix.values],
        "x": list(range(columns)), "y": list(range(rows)), "text": matrix.texts,
        "texttemplate": "%{text}", "textfont": font,
        "colorscale": [[i / last, colour] for i, colour in enumerate(matrix.colours)],
        "zmin": matrix.limits[0], "zmax": matrix.limits[1],
        "showscale": bool(matrix.bar), "colorbar": bar,
        "xgap": 2, "ygap": 2, "hoverinfo": "text",
        "xaxis": f"x{axis}", "yaxis": f"y{axis}",
    }  # fmt: skip


def bars_of(bars: Bars, axis: str, listed: bool, lying: bool) -> Json:
    """One layer of bars."""
    places, lengths = list(range(len(bars.heights))), _numbers(bars.heights)
    trace: Json = {
        "type": "bar", "name": text_of(bars.label), "legendgroup": bars.label, "showlegend": listed,
        "x": lengths if lying else places, "y": places if lying else lengths,
        "orientation": "h" if lying else "v", "width": 0.7 if lying else 0.6,
        "xaxis": f"x{axis}", "yaxis": f"y{axis}",
        "marker": {"color": bars.colour, "pattern": {"shape": bars.hatch, "fgcolor": "#ffffff",
                                                     "fillmode": "overlay", "solidity": 0.25}},
    }  # fmt: skip
    if bars.texts:
        trace |= {
            "text": [f"<b>{text_of(text)}</b>" if text else "" for text in bars.texts],
            "textposition": "inside", "insidetextanchor": "middle", "textangle": 0,
            "insidetextfont": {"color": "#ffffff", "size": FONT_PX - 2},
        }  # fmt: skip
    return trace


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


def text_of(text: str) -> str:
    """Plotly reads labels as a little HTML."""
    return html.escape(text, quote=False).replace("\n", "<br>")
