"""What a figure shows, as plain frozen values; the renderers know how it is drawn."""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass

import numpy as np

from simcompare import engines
from simcompare.trajectory import Array

#: a line of more points than this is thinned out before it is drawn
MOST_POINTS = 5000
# Okabe and Ito: told apart by colour-blind readers; yellow is left out, it vanishes on white
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
_MARKERS = ("circle", "square", "diamond", "triangle-up", "triangle-down", "x", "star")


@dataclass(frozen=True)
class Style:
    """How one source looks in every figure; it is never told by its colour alone.

    Attributes:
        colour: as ``#rrggbb``.
        dash: solid, dash, dot, dashdot, longdash or longdashdot.
        marker: circle, square, diamond, triangle-up, triangle-down, x or star.
        width: width of lines [px].
        hollow: whether markers are outlines.
    """

    colour: str
    dash: str = "solid"
    marker: str = "circle"
    width: float = 2.5
    hollow: bool = False


TRUTH_STYLE = Style("#BDBDBD", width=8.0)
MEASURED_STYLE = Style("#000000", marker="circle")


@dataclass(frozen=True)
class Series:
    """One line or row of points.

    Attributes:
        label: name in the legend; the same label is listed once.
        x: where (n,).
        y: values (n,); NaN is a gap.
        style: how it looks.
        u: half-length of the uncertainty bars (n,), ``None`` for none.
        points: whether it is drawn as points.
        line: whether it is drawn as a line.
    """

    label: str
    x: Array
    y: Array
    style: Style
    u: Array | None = None
    points: bool = False
    line: bool = True


@dataclass(frozen=True)
class Band:
    """A range of y that means something: a tolerance, or the limits of a measurement."""

    low: float
    high: float
    label: str
    centre: float | None = None


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    Attributes:
        title: above the axes.
        x_label: quantity and unit.
        y_label: quantity and unit.
        series: drawn in this order, the first at the bottom.
        bands: drawn below everything.
        x_ticks: names at x = 0, 1, 2, …; ``None`` for numbers.
        log_y: whether y is logarithmic.
        log_x: whether x is logarithmic.
        y_range: lowest and highest y, ``None`` to fit the data.
        whole_x: whether x is a count, so that only whole numbers mean something.
        weight: part of the figure's width that it takes, relative to the other panels.
    """

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    bands: tuple[Band, ...] = ()
    x_ticks: tuple[str, ...] | None = None
    log_y: bool = False
    log_x: bool = False
    y_range: tuple[float, float] | None = None
    whole_x: bool = False
    weight: float = 1.0

    @property
    def x_range(self) -> tuple[float, float] | None:
        """Lowest and highest x, ``None`` to fit the data."""
        if self.x_ticks is not None:
            return -0.5, len(self.x_ticks) - 0.5
        values = [series.x for series in self.series if len(series.x)]
        if not self.whole_x or not values:
            return None
        every = np.concatenate(values)
        return float(every.min()) - 0.5, float(every.max()) + 0.5


@dataclass(frozen=True)
class Figure:
    """Panels side by side.

    Attributes:
        name: short name, for files and anchors.
        title: what it is.
        caption: what to see in it, one or two sentences.
        panels: from left to right.
        share_y: whether the panels have one y axis.
    """

    name: str
    title: str
    caption: str
    panels: tuple[Panel, ...]
    share_y: bool = False


@functools.cache
def style_of(engine: str) -> Style:
    """The look of an engine, the same in every report."""
    known = engines.names()
    # an engine of somebody else's that is no longer installed still gets a look of its own
    number = known.index(engine) if engine in known else len(known) + sum(map(ord, engine))
    turn = number // len(_COLOURS)
    return Style(
        _COLOURS[number % len(_COLOURS)],
        _DASHES[(number + turn) % len(_DASHES)],
        _MARKERS[number % len(_MARKERS)],
    )


def spread(i: int, count: int, width: float = 0.4) -> float:
    """Sideways shift of the i-th of some series, so that their uncertainty bars stand apart."""
    return (i - (count - 1) / 2) / max(count, 2) * width


def fitted_range(series: tuple[Series, ...], bands: tuple[Band, ...]) -> tuple[float, float]:
    """A y range in which all points, their uncertainties and the bands are seen."""
    parts = [np.array([band.low, band.high]) for band in bands]
    for row in series:
        u = np.zeros(len(row.y)) if row.u is None else np.nan_to_num(row.u)
        parts += [row.y - u, row.y + u]
    values = np.concatenate(parts) if parts else np.zeros(0)
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    margin = 0.08 * (high - low) or 0.1 * abs(high) or 1.0
    return low - margin, high + margin


def decimated(x: Array, y: Array, most: int = MOST_POINTS) -> tuple[Array, Array]:
    """At most so many points of a line: the lowest and highest of every bin, and its gaps.

    Impacts stay as sharp as they are, which even thinning would round off.
    """
    if len(y) <= most:
        return x, y
    edges = np.linspace(0, len(y), max(most // 3, 1) + 1).astype(int)
    keep = {0, len(y) - 1}
    gaps = ~np.isfinite(y)
    low, high = np.where(gaps, math.inf, y), np.where(gaps, -math.inf, y)
    for begin, end in itertools.pairwise(edges):
        if gaps[begin:end].any():
            keep.add(int(begin + np.argmax(gaps[begin:end])))
        keep.add(int(begin + np.argmin(low[begin:end])))
        keep.add(int(begin + np.argmax(high[begin:end])))
    chosen = np.array(sorted(keep))
    return x[chosen], y[chosen]
