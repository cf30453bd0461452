"""Figures of single events, such as every bounce."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from simcompare.comparison.comparison import Score
from simcompare.model.trajectory import TRUTH
from simcompare.notation import capital
from simcompare.reports.render.figures import Band, Figure, Panel, Series, fitted_range, spread
from simcompare.reports.render.styles import TRUTH_STYLE
from simcompare.reports.run import runs
from simcompare.reports.run.event_values import column, deviation_scale, deviation_unit, events_of
from simcompare.reports.run.source_styles import hollow_entries, level_look
from simcompare.results.run import Run

_X_LABEL = "number of the event"

#: scores of the events of one measure, by source and level
Events = Mapping[tuple[str, str], Sequence[Score]]


def event_measures(run: Run) -> list[str]:
    """What was measured per event and has a truth; what has a tolerance first.

    Series over an axis of their own are curves, see ``curve_figures``.
    """
    curves = {name for pair in runs.axes(run).items() for name in pair}
    return runs.toleranced_first(
        run,
        (
            s.measure
            for s in run.record.scores
            if s.index is not None and s.truth is not None and s.measure not in curves
        ),
    )


def events_figure(run: Run, measure: str) -> Figure:
    """One measure per event: its values, and how far they are from the truth."""
    events = events_of(run, measure)
    words, judged = runs.measure_words(measure), runs.judged_modes(run)
    modes = [*judged, *(mode for mode in runs.modes(run) if mode not in judged)]
    true = _true_line(events)
    values = (true, *_series(run, events, modes, None), *hollow_entries(run, true.x))
    label = runs.label(measure, next(iter(events.values()))[0].unit)
    caption = (
        "Bars are one standard deviation over the repeats to either side; "
        "engines stand side by side so that their bars can be told apart."
    )
    # what is the engine's own and what we add to it never share a panel
    panels = (
        Panel("value", _X_LABEL, label, values, integer_x=True),
        *(_deviations(run, measure, events, mode) for mode in judged),
    )
    title = f"{capital(words)}, event by event"
    return Figure(f"events-{measure}", title, caption, panels)


def _deviations(run: Run, measure: str, events: Events, mode: str) -> Panel:
    """How far the events are from the truth at one level."""
    relative = all(score.truth for scores in events.values() for score in scores)
    unit = deviation_unit(next(iter(events.values()))[0].unit, relative=relative)
    series = _series(run, events, [mode], relative)
    bands = _tolerance_band(run, measure) if relative else ()
    return Panel(
        f"{runs.mode_words(mode)}: deviation",
        _X_LABEL,
        f"deviation{unit}",
        series,
        bands,
        y_range=fitted_range(series, bands),
        integer_x=True,
        weight=1.7 if len(runs.judged_modes(run)) == 1 else 1.2,
    )


def _true_line(events: Events) -> Series:
    longest = max(events.values(), key=len)
    known = [score for score in longest if score.truth is not None]
    x, y = column(known, "index"), column(known, "truth")
    # a single event has no line; its truth is seen a little to either side
    if len(x) == 1:
        x, y = np.array([x[0] - 0.4, x[0] + 0.4]), np.repeat(y, 2)
    return Series(f"truth ({TRUTH})", x, y, TRUTH_STYLE)


def _series(
    run: Run, events: Events, modes: Sequence[str], relative: bool | None
) -> tuple[Series, ...]:
    """Values where ``relative`` is None, else deviations from the truth, in per cent or not."""
    names, series = runs.names(run), []
    for mode in modes:
        for i, name in enumerate(names):
            known = [s for s in events.get((name, mode), []) if s.truth is not None]
            if not known:
                continue
            y, u = column(known, "value"), column(known, "u")
            if relative is not None:
                true = column(known, "truth")
                scale = deviation_scale(true, relative=relative)
                y, u = (y - true) * scale, u * scale
            x = column(known, "index") + spread(i, len(names))
            bars = u if np.isfinite(u).any() else None
            style = level_look(run, name, mode)
            series.append(Series(name, x, y, style, bars, points=True, line=len(known) > 1))
    return tuple(series)


def _tolerance_band(run: Run, measure: str) -> tuple[Band, ...]:
    """The tolerance of the whole run's value, in per cent of its truth.

    Of several steps, which may have tolerances of their own, the tightest.
    """
    halves = [
        100 * accepted / abs(score.truth)
        for score in run.record.scores
        if score.measure == measure and score.index is None and score.truth
        if (accepted := runs.width(run, score)) is not None
    ]
    half = min(halves if runs.steps(run) else halves[:1], default=None)
    return () if half is None else (Band(-half, half, "tolerance of the mean", 0.0),)
