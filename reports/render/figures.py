"""What a figure shows, as plain frozen values; the renderers know how it is drawn."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.reports.render.ranges import calm_range
from simcompare.reports.render.styles import Style

#: more panels than this side by side cannot be read
MAX_PANELS = 3
#: a map that is so many times longer than wide has two scales
_SLIM = 4.0
#: so many cells with numbers fit side by side in letters of the usual size
_CELLS = 18
#: so many letters fit side by side below a panel
_TICK_LETTERS = 50
#: sizes whose ticks read well without a power of ten
_PLAIN_SIZES = (1e-3, 1e6)


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
        shaded: whether the uncertainty is a shaded band about the line instead of bars; the band
            alone where neither points nor a line are drawn.
    """

    label: str
    x: Array
    y: Array
    style: Style
    u: Array | None = None
    points: bool = False
    line: bool = True
    shaded: bool = False


@dataclass(frozen=True)
class Bars:
    """One layer of stacked bars.

    Attributes:
        label: name in the legend; the same label is listed once.
        heights: of the bars at x = 0, 1, 2, … (n,), none below 0; lengths where the bars lie.
        colour: as ``#rrggbb``.
        hatch: "", "/", "x" or ".": told apart in print as well.
        texts: written into each bar (n,); nothing where empty.
    """

    label: str
    heights: Array
    colour: str
    hatch: str = ""
    texts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Matrix:
    """Cells with a number in each; told by the numbers, not by colour alone.

    Attributes:
        values: rows from the top (n, m); NaN is an empty cell.
        places: digits after the point.
        limits: values at the first and the last of the colours.
        colours: of the cells, as ``#rrggbb``, pale enough for dark digits; evenly between these.
        empty: what is written into an empty cell.
        bar: quantity and unit of a bar that shows the colours; empty for no bar.
    """

    values: Array
    places: int = 2
    limits: tuple[float, float] = (-1.0, 1.0)
    colours: tuple[str, ...] = ("#5AA6DC", "#FFFFFF", "#F0A35C")
    empty: str = "–"
    bar: str = ""

    @property
    def texts(self) -> list[list[str]]:
        """What is written into the cells."""
        return [
            [
                f"{v:.{self.places}f}".replace("-", "−") if math.isfinite(v) else self.empty
                for v in row
            ]
            for row in self.values.tolist()
        ]


#: for sizes that have no sign: the smallest is the darkest
GREYS = ("#8C8C8C", "#FFFFFF")


@dataclass(frozen=True)
class Band:
    """A range of y that means something: a tolerance, or the limits of a measurement."""

    low: float
    high: float
    label: str
    centre: float | None = None


@dataclass(frozen=True)
class Span:
    """A range of x that means something, or one instant where both ends are the same.

    Attributes:
        low: where it begins.
        high: where it ends.
        label: name in the legend, listed once; empty for none.
        rows: lowest and highest y of it, ``None`` for the whole height.
    """

    low: float
    high: float
    label: str = ""
    rows: tuple[float, float] | None = None


@dataclass(frozen=True)
class Note:
    """A few letters beside what is drawn.

    Attributes:
        x: where.
        y: where.
        text: the letters.
        side: side of the place on which they stand: left, right or center.
        colour: as ``#rrggbb``.
    """

    x: float
    y: float
    text: str
    side: str = "right"
    colour: str = "#222222"

    @property
    def anchor(self) -> str:
        """End of the letters that is at the place: left, right or center."""
        return {"left": "right", "right": "left"}.get(self.side, "center")


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
        integer_x: whether x is a count, so that only whole numbers mean something.
        weight: part of the figure's width that it takes, relative to the other panels.
        bars: layers of stacked bars, from the bottom; below the series.
        spans: ranges of x and instants, drawn below everything.
        y_ticks: names at y = 0, 1, 2, … from the top; values then run along x, so that bars and
            the bars of uncertainties lie. ``None`` for numbers.
        x_limits: lowest and highest x, ``None`` to fit the data.
        matrix: cells under ``x_ticks`` and beside ``y_ticks``, which it needs.
        notes: letters above everything.
        is_map: whether a metre should be as long along x as along y, where that leaves both to see.
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
    integer_x: bool = False
    weight: float = 1.0
    bars: tuple[Bars, ...] = ()
    spans: tuple[Span, ...] = ()
    y_ticks: tuple[str, ...] | None = None
    x_limits: tuple[float, float] | None = None
    matrix: Matrix | None = None
    notes: tuple[Note, ...] = ()
    is_map: bool = False

    @property
    def has_one_scale(self) -> bool:
        """Whether it is a map that is not far longer than wide."""
        known = [row for row in self.series if len(row.x)]
        if not self.is_map or not known:
            return False
        sides = [np.ptp(np.concatenate(rows)) for rows in
                 ([row.x for row in known], [row.y for row in known])]  # fmt: skip
        return bool(max(sides) < _SLIM * min(sides))

    @property
    def x_range(self) -> tuple[float, float] | None:
        """Lowest and highest x, ``None`` to fit the data."""
        if self.x_limits is not None:
            return self.x_limits
        if self.bars and self.y_ticks is not None:
            return 0.0, self._longest
        if self.x_ticks is not None:
            return -0.5, len(self.x_ticks) - 0.5
        values = [series.x for series in self.series if len(series.x)]
        if not self.integer_x or not values:
            return None
        every = np.concatenate(values)
        return float(every.min()) - 0.5, float(every.max()) + 0.5

    @property
    def _longest(self) -> float:
        """Length of the axis along which bars are stacked."""
        return 1.08 * float(np.sum([bars.heights for bars in self.bars], axis=0).max()) or 1.0

    @property
    def lying(self) -> bool:
        """Whether values run along x, so that bars lie."""
        return self.y_ticks is not None

    @property
    def x_names(self) -> list[str]:
        """The names at x as they are written; those that are slanted have one line."""
        ticks = self.x_ticks or ()
        return [tick.replace("\n", " ") if self.slanted else tick for tick in ticks]

    @property
    def slanted(self) -> bool:
        """Whether the names at the ticks would run into each other if they lay flat."""
        lines = [line for tick in self.x_ticks or () for line in tick.split("\n")]
        return len(self.x_ticks or ()) * max(map(len, lines), default=0) > _TICK_LETTERS


@dataclass(frozen=True)
class Figure:
    """Panels side by side.

    Attributes:
        name: short name, for files and anchors.
        title: what it is.
        caption: what to see in it, one or two sentences.
        panels: from left to right.
        share_y: whether the panels have one y axis.
        height: of the figure, relative to what is usual.
    """

    name: str
    title: str
    caption: str
    panels: tuple[Panel, ...]
    share_y: bool = False
    height: float = 1.0

    def crowds(self, panel: Panel) -> bool:
        """Whether the numbers in the cells of a panel would run into each other."""
        return len(self.panels) * len(panel.x_ticks or ()) > _CELLS

    @property
    def legend(self) -> dict[str, Series]:
        """The series that stands for each label: one that is not hollow where there is one."""
        rows = [series for panel in self.panels for series in panel.series]
        series_of: dict[str, Series] = {}
        for series in rows:
            if series.label not in series_of or series_of[series.label].style.hollow:
                series_of[series.label] = series
        return series_of

    def y_range(self, panel: Panel) -> tuple[float, float] | None:
        """Lowest and highest y of one of the panels, ``None`` to fit the data."""
        if panel.y_range is not None or panel.log_y:
            return panel.y_range
        if panel.y_ticks is not None:
            return len(panel.y_ticks) - 0.5, -0.5
        if panel.bars:
            return 0.0, panel._longest
        panels = self.panels if self.share_y else (panel,)
        return calm_range(_values(row for one in panels for row in one.series))

    def plain_y(self, panel: Panel) -> bool:
        """Whether the numbers at the y axis of a panel read well without a power of ten."""
        low, high = self.y_range(panel) or (0.0, 0.0)
        values = np.append(_values(panel.series), (low, high))
        return _PLAIN_SIZES[0] <= float(np.abs(values).max()) < _PLAIN_SIZES[1]


def spread(i: int, count: int, width: float = 0.4) -> float:
    """Sideways shift of the i-th of some series, so that their uncertainty bars stand apart."""
    return (i - (count - 1) / 2) / max(count, 2) * width


def fitted_range(series: tuple[Series, ...], bands: tuple[Band, ...]) -> tuple[float, float]:
    """A y range in which all points, their uncertainties and the bands are seen."""
    values = np.append(_values(series), [(band.low, band.high) for band in bands])
    if len(values) == 0:
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    margin = 0.08 * (high - low)
    return calm_range(values) or (low - margin, high + margin)


def _values(series: Iterable[Series]) -> Array:
    """Every finite y of some series with the ends of its uncertainty bars."""
    parts = [np.zeros(0)]
    for row in series:
        u = np.zeros(len(row.y)) if row.u is None else np.nan_to_num(row.u)
        parts += [row.y - u, row.y + u]
    values = np.concatenate(parts)
    return values[np.isfinite(values)]
