"""Figures as plotly's JSON, written without the plotly package; its script is inlined once."""

from __future__ import annotations

import base64
import functools
import importlib.util
import json
from pathlib import Path

import numpy as np

from simcompare.errors import OutputError
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.plotly_traces import (
    FONT_PX,
    INK,
    Json,
    band_of,
    bars_of,
    matrix_of,
    note_of,
    shade_of,
    span_of,
    text_of,
    trace_of,
)

#: space between panels, as part of the width
_GAP, _SHARED_GAP = 0.12, 0.05
#: height of the legend above the panels, as part of a plot of usual height
_LEGEND_UP = 0.13
#: numbers along the x axes of all panels together
_TICKS = 14
#: whole numbers; plotly's own are small digits without their power beside large powers of ten
_LOG_TICKS = "~g"
_GRID = "#E3E3E3"
#: more coordinates than these are written as binary numbers
_LONG = 100


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
    found = as_dict(figure)
    found["data"] = list(map(_packed, found["data"]))
    text = json.dumps(found, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _packed(trace: Json) -> Json:
    """A trace with its long coordinates as binary numbers, which are half as long as digits."""
    long = {key: trace[key] for key in ("x", "y") if len(trace.get(key, ())) > _LONG}
    return {**trace, **{key: _binary(values) for key, values in long.items()}}


def _binary(values: list[float | None]) -> Json:
    single = np.array(values, dtype="<f4")  # None becomes NaN, which is a gap
    return {"dtype": "f4", "bdata": base64.b64encode(single.tobytes()).decode("ascii")}


def as_dict(figure: Figure) -> Json:
    """A figure as plotly's ``{"data": …, "layout": …}``; numbers that are not finite are null."""
    drawing = _Drawing(figure)
    for i, (panel, domain) in enumerate(zip(figure.panels, _domains(figure), strict=True)):
        drawing.add(panel, domain, "" if i == 0 else str(i + 1))
    return {"data": drawing.data, "layout": drawing.layout}


class _Drawing:
    """What is collected while the panels of a figure are drawn.

    Attributes:
        data: traces.
        layout: everything else.
    """

    def __init__(self, figure: Figure) -> None:
        self._figure = figure
        self._legend = figure.legend
        self._ranks = {label: rank for rank, label in enumerate(self._legend, start=1)}
        self._listed = {""}
        self._heads: list[Json] = []
        self._notes: list[Json] = []
        self._shapes: list[Json] = []
        self._axes: Json = {}
        self.data: list[Json] = []

    @property
    def layout(self) -> Json:
        """Axes, shapes and texts; notes behind the heads, which the page finds by their number."""
        font = {"size": FONT_PX}
        legend = {
            "orientation": "h", "x": 0, "y": round(1 + _LEGEND_UP / self._figure.height, 4),
            "yanchor": "bottom", "font": font,
        }  # fmt: skip
        return {
            "font": {**font, "color": INK},
            "paper_bgcolor": "#ffffff",
            "plot_bgcolor": "#ffffff",
            "separators": ".",  # no comma between thousands
            "margin": {"l": 84, "r": 16, "t": 96, "b": 64},
            "legend": legend,
            "hoverlabel": {"font": {"size": FONT_PX - 2}},
            "annotations": self._heads + self._notes,
            "shapes": self._shapes,
            "barmode": "stack",
            **self._axes,
        }

    def add(self, panel: Panel, domain: tuple[float, float], axis: str) -> None:
        """Draws a panel on the axes of a number."""
        self._axes[f"xaxis{axis}"] = _x_axis(self._figure, panel, domain, axis)
        self._axes[f"yaxis{axis}"] = _y_axis(self._figure, panel, axis)
        self._heads.append(_head(panel.title, (domain[0] + domain[1]) / 2))
        self._notes += [note_of(note, axis) for note in panel.notes]
        for band in panel.bands:
            self._shapes += band_of(band, axis, self._is_new(band.label))
        for span in panel.spans:
            self._shapes.append(span_of(span, axis, self._is_new(span.label)))
        if panel.matrix is not None:
            small = self._figure.crowds(panel)
            self.data.append(matrix_of(panel.matrix, axis, small=small))
        for bars in panel.bars:
            self.data.append(bars_of(bars, axis, self._is_new(bars.label), panel.lying))
        for series in panel.series:
            self._add_series(series, axis, "error_x" if panel.lying else "error_y")

    def _add_series(self, series: Series, axis: str, error: str) -> None:
        chosen = series is self._legend.get(series.label)
        rank = {"legendrank": self._ranks[series.label]}
        drawn = series.line or series.points
        if series.shaded:
            self.data.append(shade_of(series, axis, listed=chosen and not drawn) | rank)
        if drawn:
            self.data.append(trace_of(series, axis, chosen, error) | rank)
        if chosen:  # once, also where two panels show the same
            self._legend.pop(series.label)

    def _is_new(self, label: str) -> bool:
        """Whether a label stands in the legend for the first time."""
        known = label in self._listed
        self._listed.add(label)
        return not known


def _domains(figure: Figure) -> list[tuple[float, float]]:
    count = len(figure.panels)
    gap = (_SHARED_GAP if figure.share_y else _GAP) if count > 1 else 0.0
    free = 1 - gap * (count - 1)
    weight = sum(panel.weight for panel in figure.panels)
    domains, start = [], 0.0
    for panel in figure.panels:
        end = start + free * panel.weight / weight
        domains.append((start, min(end, 1.0)))
        start = end + gap
    return domains


def _axis(label: str) -> Json:
    return {
        "title": {"text": text_of(label), "standoff": 10},
        "gridcolor": _GRID,
        "linecolor": "#999999",
        "zeroline": False,
        "showline": True,
        "mirror": True,
        "ticks": "outside",
        "automargin": True,
        "exponentformat": "power",
    }


def _x_axis(figure: Figure, panel: Panel, domain: tuple[float, float], number: str) -> Json:
    max_ticks = max(4, _TICKS // max(len(figure.panels), 1))
    axis = {**_axis(panel.x_label), "domain": list(domain), "anchor": f"y{number}"}
    axis |= {"tickangle": 0, "nticks": max_ticks}
    if panel.x_range is not None:
        axis["range"] = list(panel.x_range)
        if panel.integer_x:
            axis |= {"tick0": 0, "dtick": max(1, round((panel.x_range[1]) / 10))}
    if panel.log_x:
        axis |= {"type": "log", "dtick": "D2", "tickformat": _LOG_TICKS}
        axis["minor"] = {"dtick": "D1", "ticks": "outside"}
    if panel.x_ticks is not None:
        axis |= {
            "tickvals": list(range(len(panel.x_ticks))),
            "ticktext": list(map(text_of, panel.x_names)),
            "tickangle": -40 if panel.slanted else 0,
        }
    return axis


def _y_axis(figure: Figure, panel: Panel, number: str) -> Json:
    shared = figure.share_y and number != ""
    axis = {**_axis("" if shared else panel.y_label), "anchor": f"x{number}"}
    if panel.log_y:
        axis |= {"type": "log", "dtick": 1, "tickformat": _LOG_TICKS}
    elif panel.y_ticks is not None:
        axis |= {
            "tickvals": list(range(len(panel.y_ticks))),
            "ticktext": list(map(text_of, panel.y_ticks)),
            "showgrid": False,
        }
    elif figure.plain_y(panel):
        axis["exponentformat"] = "none"
    y_range = figure.y_range(panel)
    if y_range is not None:
        low, high = np.log10(y_range) if panel.log_y else y_range
        axis["range"] = [float(low), float(high)]
    if shared:
        axis |= {"matches": "y", "showticklabels": False}
    if panel.has_one_scale:
        axis["scaleanchor"] = f"x{number}"
    return axis


def _head(title: str, middle: float) -> Json:
    return {
        "text": f"<b>{text_of(title)}</b>",
        "x": middle, "y": 1.02, "xref": "paper", "yref": "paper",
        "xanchor": "center", "yanchor": "bottom", "showarrow": False,
        "font": {"size": FONT_PX + 1},
    }  # fmt: skip
