"""Figures of series over an axis of their own, such as a response over frequency."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare.comparison.comparison import Score
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import TRUTH, Array
from simcompare.notation import capital
from simcompare.reports.render.figures import MAX_PANELS, Figure, Panel, Series, fitted_range
from simcompare.reports.render.styles import TRUTH_STYLE
from simcompare.reports.run import runs
from simcompare.reports.run.event_values import column, deviation_scale, deviation_unit, events_of
from simcompare.reports.run.listing import joined
from simcompare.reports.run.source_styles import hollow_entries, level_look
from simcompare.results.run import Run

#: curves of more points than this are drawn as lines only
_FEW = 40
#: what is only shown may make an axis so many times longer
_FLAT = 3.0
#: units in which a deviation is not taken as a part of the value
_ABSOLUTE = ("deg", "rad", "s")


def axes_drawn(run: Run) -> list[str]:
    """Measures that serve as an axis and were measured, in the order of the scenario."""
    measured = {score.measure for score in run.record.scores if score.index is not None}
    return [axis for axis in dict.fromkeys(runs.axes(run).values()) if axis in measured]


def leading_axis(run: Run) -> str | None:
    """The axis whose curves answer the question, ``None`` where the motion does.

    It is one of something else than time.
    """
    return next((axis for axis in axes_drawn(run) if _unit(run, axis) != "s"), None)


def curves_figures(run: Run, axis: str) -> list[Figure]:
    """Everything that is drawn over one axis, one panel each, a few panels a figure."""
    panels = [_values(plot) for plot in _plots(run, axis)]
    true = any(series.style == TRUTH_STYLE for panel in panels for series in panel.series)
    caption = f"The thick grey line is the truth ({TRUTH}). " if true else ""
    if any(one.style.hollow and one.points for panel in panels for one in panel.series):
        caption += "Full points are at the level that the panel names."
    if any(panel.y_range is not None for panel in panels):
        caption += " Hollow points far away from all others lie outside."
    return _figures(f"curves-{axis}", f"over {_words(run, axis)}", caption.strip(), panels)


def deviations_figures(run: Run, axis: str) -> list[Figure]:
    """How far every curve over an axis is from the truth; empty where there is no truth."""
    panels = [_deviations(plot) for plot in _plots(run, axis)]
    modes = " and ".join(runs.mode_words(mode) for mode in runs.judged_modes(run))
    return _figures(
        f"deviations-{axis}",
        f"over {_words(run, axis)}: deviation from the truth",
        f"Engines {modes}; an engine that is right runs along zero.",
        [panel for panel in panels if panel.series],
    )


@dataclass(frozen=True)
class _Plot:
    """What a panel shows: one measure over an axis; two levels that are judged never share one.

    Attributes:
        run: of which it is a part.
        axis: the measure that gives the x values.
        measure: the measure that gives the y values.
        mode: the level that is judged.
    """

    run: Run
    axis: str
    measure: str
    mode: str

    @property
    def unit(self) -> str:
        """Of the y values."""
        return _unit(self.run, self.measure)

    def scores(self, name: str, mode: str) -> list[Score]:
        """What is drawn of a source at a level."""
        return events_of(self.run, self.measure).get((name, mode), [])

    def panel(
        self,
        label: str,
        series: Iterable[Series],
        y_range: tuple[float, float] | None = None,
    ) -> Panel:
        """The panel with these series."""
        words, unit = runs.measure_words(self.measure), _unit(self.run, self.axis)
        if len(runs.judged_modes(self.run)) > 1:
            words += f", {runs.mode_words(self.mode)}"
        x_label = _words(self.run, self.axis) + runs.unit_words(unit)
        return Panel(words, x_label, label, tuple(series), log_x=unit == "Hz", y_range=y_range)


def _plots(run: Run, axis: str) -> list[_Plot]:
    measures = [name for name, over in runs.axes(run).items() if over == axis]
    return [_Plot(run, axis, name, mode) for name in measures for mode in runs.judged_modes(run)]


def _figures(name: str, ending: str, caption: str, panels: Sequence[Panel]) -> list[Figure]:
    """Panels in as few figures as can be read, as even as possible."""
    count = math.ceil(len(panels) / MAX_PANELS)
    size = math.ceil(len(panels) / max(count, 1))
    figures = []
    for i in range(count):
        part = tuple(panels[i * size : (i + 1) * size])
        what = dict.fromkeys(panel.title.partition(", ")[0] for panel in part)
        title = f"{capital(joined([*what]))} {ending}"
        figures.append(Figure(f"{name}-{i + 1}" if i else name, title, caption, part))
    return figures


def _values(plot: _Plot) -> Panel:
    run = plot.run
    shown = [mode for mode in runs.modes(run) if mode in SHOWN_LEVELS and mode != plot.mode]
    series = [
        _curve(plot, name, mode, scores)
        for mode in (*shown, plot.mode)
        for name in runs.names(run)
        if (scores := plot.scores(name, mode))
    ]
    true = _truth(plot)
    near = (*true, *(one for one in series if not one.style.hollow))
    label = runs.label(plot.measure, plot.unit)
    hollow = [one for one in series if one.style.hollow and one.points][:1]
    entries = [entry for one in hollow for entry in hollow_entries(run, one.x)]
    return plot.panel(label, (*true, *series, *entries), _near_range(near, series))


def _near_range(near: Sequence[Series], every: Sequence[Series]) -> tuple[float, float] | None:
    """The range of what is judged, where what is only shown would press it flat."""
    narrow, wide = (fitted_range(tuple(series), ()) for series in (near, every))
    return narrow if near and wide[1] - wide[0] > _FLAT * (narrow[1] - narrow[0]) else None


def _deviations(plot: _Plot) -> Panel:
    scores = {name: plot.scores(name, plot.mode) for name in runs.names(plot.run)}
    every = events_of(plot.run, plot.measure).values()
    truths = [score.truth for row in every for score in row if score.truth is not None]
    # a part of a value that passes through zero means nothing
    relative = plot.unit not in _ABSOLUTE and all(truths)
    series = [
        _deviation(plot, name, known, relative=relative)
        for name, row in scores.items()
        if (known := [score for score in row if score.truth is not None])
    ]
    return plot.panel(f"deviation{deviation_unit(plot.unit, relative=relative)}", series)


def _deviation(plot: _Plot, name: str, scores: Sequence[Score], *, relative: bool) -> Series:
    curve, true = _curve(plot, name, plot.mode, scores), column(scores, "truth")
    return replace(curve, y=(curve.y - true) * deviation_scale(true, relative=relative))


def _curve(plot: _Plot, name: str, mode: str, scores: Sequence[Score]) -> Series:
    x, style = _places(plot, (name, mode), scores), level_look(plot.run, name, mode)
    few = len(scores) <= _FEW
    line = not (few and style.hollow)
    return Series(name, x, column(scores, "value"), style, points=few, line=line)


def _truth(plot: _Plot) -> list[Series]:
    for key, scores in events_of(plot.run, plot.measure).items():
        known = [score for score in scores if score.truth is not None]
        if known:
            x = _places(plot, key, known, of="truth")
            return [Series(f"truth ({TRUTH})", x, column(known, "truth"), TRUTH_STYLE)]
    return []


def _places(plot: _Plot, key: tuple[str, str], scores: Sequence[Score], of: str = "value") -> Array:
    """Where on the axis the scores of one source stand; what has no place there is a gap."""
    events = events_of(plot.run, plot.axis).get(key, [])
    places = dict(zip([score.index for score in events], column(events, of), strict=True))
    return np.array([places.get(score.index, np.nan) for score in scores])


def _words(run: Run, axis: str) -> str:
    """What an axis is called; every axis of time has a name of its own in a scenario."""
    return "time" if _unit(run, axis) == "s" else runs.measure_words(axis)


def _unit(run: Run, measure: str) -> str:
    return next((score.unit for score in run.record.scores if score.measure == measure), "1")
