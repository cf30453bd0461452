"""Figures for a paper, drawn by matplotlib without its global state."""

from __future__ import annotations

import functools
import io
import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from simcompare.reports.render.decimation import decimated
from simcompare.reports.render.figures import (
    Band,
    Bars,
    Figure,
    Matrix,
    Note,
    Panel,
    Series,
    Span,
)
from simcompare.reports.render.output import MADE_BY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

FORMATS = ("pdf", "png", "svg")
#: ships with matplotlib: the same on every machine
FONT = "DejaVu Sans"
DPI = 300
#: of a figure in a notebook, one and a half pixels to that of a browser
_SCREEN_DPI = 144
#: two columns of a journal [inch]; a single panel takes one and a half
_WIDTH, _SINGLE_WIDTH, _HEIGHT = 7.2, 5.0, 3.1
#: powers of ten between which numbers are written whole
_PLAIN = (-3, 6)
#: numbers along an axis: a single one tells no scale
_LEAST_TICKS = 3
#: numbers along a logarithmic axis that do not touch, and which of each power of ten they are
_MOST_ALONG, _MOST_UP = 8, 12
_PLACES = ((1.0, 2.0, 5.0), (1.0, 3.0), (1.0,))
#: from pixels on a screen to points on paper
_SCALE = 0.55
#: size of a legend entry of 8 points without its text, and of a letter of it
_ENTRY_INCH, _LETTER_INCH = 0.62, 0.068
_DASHES: dict[str, Any] = {
    "solid": "-",
    "dash": (0, (5, 2)),
    "dot": (0, (1, 1.3)),
    "dashdot": (0, (6, 2, 1, 2)),
    "longdash": (0, (9, 3)),
    "longdashdot": (0, (9, 2, 1, 2)),
}
_MARKERS = {
    "circle": "o", "square": "s", "diamond": "D", "triangle-up": "^",
    "triangle-down": "v", "triangle-left": "<", "triangle-right": ">", "x": "X", "star": "*",
}  # fmt: skip
_LOOK: Any = {  # matplotlib types every key by itself
    "font.family": FONT,
    "font.size": 8,
    "axes.titlesize": 8.5,
    "legend.fontsize": 8,
    "axes.grid": True,
    "grid.color": "#E3E3E3",
    "axes.axisbelow": True,
    "pdf.fonttype": 42,  # text stays text in a vector program
    "svg.hashsalt": "simcompare",
    "hatch.linewidth": 0.5,
}


#: what a PDF says of itself
_OF_PDF = {"CreationDate": None, "Creator": MADE_BY}


def rendered(figure: Figure, format: str) -> bytes:
    """A figure as the content of a "pdf", "png" or "svg" file; the same bytes every time."""
    import matplotlib as mpl

    with mpl.rc_context(_LOOK):
        stream = io.BytesIO()
        # a date in the file would make two equal reports differ
        metadata = {
            "pdf": _OF_PDF, "svg": {"Date": None, "Creator": MADE_BY}, "png": {"Software": MADE_BY},
        }[format]  # fmt: skip
        canvas(figure).savefig(stream, format=format, dpi=DPI, metadata=metadata)
    return stream.getvalue()


def document(pages: Sequence[Canvas]) -> bytes:
    """Pages as one PDF file."""
    import matplotlib as mpl
    from matplotlib.backends.backend_pdf import PdfPages

    stream = io.BytesIO()
    with mpl.rc_context(_LOOK), PdfPages(stream, metadata=_OF_PDF) as file:
        for page in pages:
            file.savefig(page)
    return stream.getvalue()


def blank(size: tuple[float, float]) -> Canvas:
    """An empty page [inch]; a notebook shows it by itself."""
    import matplotlib as mpl

    with mpl.rc_context(_LOOK):
        return _kind_of_canvas()(figsize=size, layout="constrained")


def canvas(figure: Figure) -> Canvas:
    """A figure as matplotlib's, sized for a paper; a notebook shows it by itself."""
    import matplotlib as mpl

    page = blank(size(figure))
    with mpl.rc_context(_LOOK):
        draw(page, figure)
    return page


def size(figure: Figure) -> tuple[float, float]:
    """Width and height [inch]."""
    count = len(figure.panels)
    width = _SINGLE_WIDTH if count == 1 else _WIDTH * max(1.0, count / 2)
    return width, _HEIGHT * figure.height


def shown(page: Canvas) -> bytes:
    """What a notebook shows of a figure, as the content of a PNG file."""
    import matplotlib as mpl

    with mpl.rc_context(_LOOK):
        stream = io.BytesIO()
        page.savefig(stream, format="png", dpi=_SCREEN_DPI)
    return stream.getvalue()


@functools.cache
def _kind_of_canvas() -> type[Canvas]:
    """Matplotlib's figure, which a notebook by itself shows only where pyplot made it."""
    from matplotlib.figure import Figure as Plain

    class Shown(Plain):
        """A figure that a notebook shows."""

        def _repr_png_(self) -> bytes:
            return shown(self)

    return Shown


def draw(page: Any, figure: Figure) -> None:  # noqa: ANN401  (a Figure or a SubFigure of matplotlib)
    """Draws the panels side by side with one legend above them."""
    widths = [panel.weight for panel in figure.panels]
    row = page.subplots(1, len(widths), sharey=figure.share_y, squeeze=False, width_ratios=widths)[
        0
    ]
    legend = figure.legend
    handles: dict[str, Any] = dict.fromkeys(legend)
    for i, (axes, panel) in enumerate(zip(row, figure.panels, strict=True)):
        for band in panel.bands:
            handles.setdefault(band.label, _band(axes, band))
        for span in panel.spans:
            handle = _span(axes, span)
            if span.label:
                handles.setdefault(span.label, handle)
        if panel.matrix is not None:
            _matrix(axes, panel.matrix, small=figure.crowds(panel))
        for bars, handle in _stacked(axes, panel):
            handles.setdefault(bars.label, handle)
        for rank, series in enumerate(panel.series):
            handle = _series(axes, series, rank, lying=panel.lying)
            if series is legend[series.label]:
                handles[series.label] = handle
        _frame(axes, panel, figure.y_range(panel), labelled=i == 0 or not figure.share_y)
    if handles:
        page.legend(
            list(handles.values()), list(map(plain, handles)), loc="outside upper center",
            frameon=False, ncols=_columns(page, handles), handlelength=3.2,
        )  # fmt: skip


def _columns(page: Any, labels: Iterable[str]) -> int:  # noqa: ANN401
    """How many entries of a legend fit side by side."""
    from matplotlib import rcParams
    from matplotlib.font_manager import FontProperties

    size = FontProperties(size=rcParams["legend.fontsize"]).get_size_in_points() / 8
    widths = [size * (_ENTRY_INCH + _LETTER_INCH * len(label)) for label in labels]
    free = page.bbox.width / page.figure.dpi
    return max(1, min(len(widths), int(free / max(widths)) if sum(widths) > free else len(widths)))


def _frame(
    axes: Axes, panel: Panel, y_range: tuple[float, float] | None, *, labelled: bool
) -> None:
    from matplotlib.ticker import MaxNLocator

    axes.set_title(plain(panel.title), fontweight="bold")
    axes.set_xlabel(plain(panel.x_label))
    if labelled:
        axes.set_ylabel(plain(panel.y_label))
    if panel.log_y:
        axes.set_yscale("log")
        _numbers(axes.yaxis, _MOST_UP)
    elif (
        panel.y_ticks is None
    ):  # whole numbers where they read well, not differences from a number in a corner
        axes.ticklabel_format(axis="y", useOffset=False, scilimits=_PLAIN)
        axes.locator_params(axis="y", min_n_ticks=_LEAST_TICKS)
    if panel.log_x:
        axes.set_xscale("log")
        _numbers(axes.xaxis, _MOST_ALONG)
    elif panel.x_ticks is None:  # the same below the axes
        axes.ticklabel_format(axis="x", useOffset=False, scilimits=_PLAIN)
        axes.locator_params(axis="x", min_n_ticks=_LEAST_TICKS)
    if y_range is not None:
        axes.set_ylim(*y_range)
    if panel.integer_x:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    _names(axes, panel)
    if panel.x_range is not None:
        axes.set_xlim(*panel.x_range)
    for note in panel.notes:
        _note(axes, note)


def _numbers(axis: Any, most: int) -> None:  # noqa: ANN401
    """Numbers along a logarithmic axis: 1, 2 and 5 of each power of ten, or the powers alone."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    low, high = axis.get_view_interval()
    powers = math.log10(high / low) if low > 0 else 1.0  # an empty axis begins at 0
    places = next((one for one in _PLACES if powers * len(one) <= most), (1.0,))
    axis.set_major_locator(LogLocator(subs=places, numticks=most))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def _names(axes: Axes, panel: Panel) -> None:
    """Names instead of numbers along an axis, and one scale along both of a map."""
    if panel.has_one_scale:
        axes.set_aspect("equal", adjustable="datalim")
    if panel.x_ticks is not None:
        axes.set_xticks(range(len(panel.x_names)), list(map(plain, panel.x_names)))
        if panel.slanted:
            axes.tick_params("x", rotation=40)
            for text in axes.get_xticklabels():
                text.set(ha="right", rotation_mode="anchor")
    if panel.y_ticks is not None:
        axes.set_yticks(range(len(panel.y_ticks)), list(map(plain, panel.y_ticks)))
        axes.grid(visible=False, axis="y")


def plain(text: str) -> str:
    """A dollar sign would start mathematics."""
    return text.replace("$", r"\$")


def _span(axes: Axes, span: Span) -> Any:  # noqa: ANN401  (a handle for the legend)
    if span.low == span.high:
        return axes.axvline(span.low, color="#555555", linewidth=0.8, dashes=(3, 2), zorder=1)
    look: Any = {"color": "#000000", "alpha": 0.1, "linewidth": 0}
    if span.rows is not None:
        return axes.fill_betweenx(span.rows, span.low, span.high, **look)
    return axes.axvspan(span.low, span.high, **look)


def _band(axes: Axes, band: Band) -> Any:  # noqa: ANN401  (a handle for the legend)
    if band.centre is not None:
        axes.axhline(band.centre, color="#555555", linewidth=0.8, zorder=1)
    return axes.axhspan(band.low, band.high, color="#000000", alpha=0.1, linewidth=0)


def _matrix(axes: Axes, matrix: Matrix, *, small: bool) -> None:
    from matplotlib.colors import LinearSegmentedColormap

    colours, (low, high) = LinearSegmentedColormap.from_list("", matrix.colours), matrix.limits
    cells = axes.imshow(matrix.values, cmap=colours, vmin=low, vmax=high, aspect="auto", zorder=2)
    if matrix.bar:
        axes.figure.colorbar(cells, ax=axes, label=plain(matrix.bar))
    look: dict[str, Any] = {"fontsize": "x-small"} if small else {}
    for i, row in enumerate(matrix.texts):
        for k, text in enumerate(row):
            axes.text(k, i, text, ha="center", va="center", color="#222222", zorder=3, **look)


def _stacked(axes: Axes, panel: Panel) -> Iterator[tuple[Bars, Any]]:
    """Draws the bars, layer on layer; yields each with its handle for the legend."""
    floor: Any = 0.0
    for bars in panel.bars:
        places = range(len(bars.heights))
        look: dict[str, Any] = {
            "color": bars.colour, "hatch": 2 * bars.hatch, "edgecolor": "#ffffff", "linewidth": 0,
        }  # fmt: skip
        if panel.lying:
            drawn = axes.barh(places, bars.heights, 0.7, left=floor, **look)
        else:
            drawn = axes.bar(places, bars.heights, 0.6, bottom=floor, **look)
        _label(axes, bars, drawn)
        floor = floor + bars.heights
        yield bars, drawn


def _label(axes: Axes, bars: Bars, drawn: Any) -> None:  # noqa: ANN401
    """Writes into the bars, on their own colour so that a hatch does not cross the letters."""
    if not bars.texts:
        return
    texts = axes.bar_label(
        drawn, list(map(plain, bars.texts)), label_type="center", color="#ffffff"
    )
    for text in texts:
        if text.get_text():
            text.set_bbox({"facecolor": bars.colour, "edgecolor": "none", "pad": 1.0})


def _note(axes: Axes, note: Note) -> None:
    axes.text(
        note.x, note.y, plain(note.text), color=note.colour, ha=note.anchor,
        va="center", fontsize="small", zorder=6,
    )  # fmt: skip


def _series(axes: Axes, series: Series, rank: int, *, lying: bool) -> Any:  # noqa: ANN401  (a handle for the legend)
    style = series.style
    look: dict[str, Any] = {
        # errorbar() lifts its points by 0.1: farther apart, the later lies above
        "zorder": 2 + rank / 4,
        "color": style.colour,
        "linestyle": _DASHES[style.dash] if series.line else "none",
        "linewidth": style.width * _SCALE,
        "dash_capstyle": "butt",
    }
    if series.points:
        look |= {
            "marker": _MARKERS[style.marker],
            "markersize": 4.5,
            "markerfacecolor": "#ffffff" if style.hollow else style.colour,
        }
        look["xerr" if lying else "yerr"] = series.u
        return axes.errorbar(series.x, series.y, capsize=2, elinewidth=0.9, **look)
    if series.shaded and series.u is not None:
        shade = axes.fill_between(
            series.x, series.y - series.u, series.y + series.u,
            color=style.colour, alpha=0.25, linewidth=0,
        )  # fmt: skip
        if not series.line:
            return shade
    x, y = decimated(series.x, series.y)
    return axes.plot(x, y, **look)[0]
