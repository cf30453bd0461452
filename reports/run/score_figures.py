"""Figures of scores: one per event, and all that was judged at a glance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simcompare.compare.comparison import FAIL, Score
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import TRUTH, Array
from simcompare.reports.render.figures import (
    TRUTH_STYLE,
    Band,
    Figure,
    Panel,
    Series,
    fitted_range,
    spread,
)
from simcompare.reports.run import runs
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

#: smaller deviations, in tolerances, are drawn here; a logarithm has no zero
LEAST_SHARE = 1e-3


def event_measures(run: Run) -> list[str]:
    """What was measured per event and has a truth; what has a tolerance first.

    Series over an axis of their own are curves, see ``curves``.
    """
    curves = {name for pair in runs.axes(run).items() for name in pair}
    return runs.toleranced_first(
        run,
        (
            s.measure
            for s in run.scores
            if s.index is not None and s.truth is not None and s.measure not in curves
        ),
    )


def events_of(run: Run, measure: str) -> dict[tuple[str, str], list[Score]]:
    """Scores of one measure by source and mode, in the order of the events."""
    found: dict[tuple[str, str], list[Score]] = {}
    for score in run.scores:
        if score.measure == measure and score.index is not None:
            found.setdefault((score.source, score.contact), []).append(score)
    return {key: sorted(rows, key=lambda s: s.index or 0) for key, rows in found.items()}


def events_figure(run: Run, measure: str) -> Figure:
    """One measure per event: its values, and how far they are from the truth."""
    rows = events_of(run, measure)
    words = runs.measure_words(measure)
    unit = next(iter(rows.values()))[0].unit
    number = "number of the event"
    judged = runs.judged_modes(run)
    relative = all(score.truth for found in rows.values() for score in found)
    bands = _tolerance_band(run, measure) if relative else ()
    modes = [*judged, *(mode for mode in runs.modes(run) if mode not in judged)]
    values = (_true_line(rows), *_event_series(run, rows, modes, None))
    left = Panel("value", number, f"{words}{runs.unit_words(unit)}", values, whole_x=True)
    right = []
    for mode in judged:  # what is the engine's own and what we add to it never share a panel
        deviations = _event_series(run, rows, [mode], relative)
        right.append(
            Panel(
                f"{runs.mode_words(mode)}: deviation",
                number,
                "deviation (%)" if relative else f"deviation{runs.unit_words(unit)}",
                deviations,
                bands,
                y_range=fitted_range(deviations, bands),
                whole_x=True,
                weight=1.7 if len(judged) == 1 else 1.2,
            )
        )
    caption = (
        "Bars are one standard deviation over the repeats to either side; "
        "engines stand side by side so that their bars can be told apart."
    )
    hollow = [runs.mode_words(mode) for mode in modes if mode in SHOWN_LEVELS]
    if hollow and len(modes) > 1:
        caption += f" Hollow points are the engines {' or '.join(hollow)}."
    title = f"{words[0].upper()}{words[1:]}, event by event"
    return Figure(f"events-{measure}", title, caption, (left, *right))


def contrast_figure(run: Run) -> Figure | None:
    """Deviations in tolerances, by default beside assisted; ``None`` where nothing has a truth."""
    measures = runs.judged(run)
    if not measures:
        return None
    ticks = tuple(runs.measure_words(name).replace(" ", "\n") for name in measures)
    panels = []
    for mode in runs.modes(run):
        names = runs.names(run)
        series = tuple(
            Series(name, x, y, look(run, name), points=True, line=False)
            for i, name in enumerate(names)
            for x, y in [_shares(run, name, mode, spread(i, len(names)))]
            if np.isfinite(y).any()
        )
        panels.append(
            Panel(
                runs.mode_title(mode),
                "",
                "deviation ÷ tolerance",
                series,
                x_ticks=ticks,
                log_y=True,
            )
        )
    highest = max((float(np.nanmax(s.y)) for p in panels for s in p.series), default=1.0)
    y_range = (0.6 * LEAST_SHARE, 2 * max(highest, 3.0))
    band = Band(y_range[0], 1.0, "within tolerance")
    caption = (
        "Lower is better; below 1, in the shaded band, is within the scenario's tolerance. "
        "The scale is logarithmic and ends at a thousandth: smaller deviations are drawn there."
    )
    lost = sorted({
        f"{runs.measure_words(score.measure)} in {score.source}, {runs.mode_words(score.contact)}"
        for score in run.scores
        if score.index is None and score.measure in measures
        and score.value is None and score.verdict == FAIL
    })  # fmt: skip
    if lost:
        caption += f" Missed, and not drawn, since not every repeat has it: {'; '.join(lost)}."
    return Figure(
        "contrast",
        "Deviation from the truth, in tolerances",
        caption,
        tuple(replace(panel, bands=(band,), y_range=y_range) for panel in panels),
        share_y=True,
    )


def _shares(run: Run, name: str, mode: str, shift: float) -> tuple[Array, Array]:
    found = [runs.score_of(run, name, mode, measure) for measure in runs.judged(run)]
    shares = [None if score is None else runs.share_of_tolerance(run, score) for score in found]
    y = np.array([np.nan if s is None else max(s, LEAST_SHARE) for s in shares])
    return np.arange(len(shares), dtype=float) + shift, y


def _true_line(rows: dict[tuple[str, str], list[Score]]) -> Series:
    longest = max(rows.values(), key=len)
    known = [score for score in longest if score.truth is not None]
    x, y = column(known, "index"), column(known, "truth")
    # a single event has no line; its truth is seen a little to either side
    if len(x) == 1:
        x, y = np.array([x[0] - 0.4, x[0] + 0.4]), np.repeat(y, 2)
    return Series(f"truth ({TRUTH})", x, y, TRUTH_STYLE)


def _event_series(
    run: Run,
    rows: dict[tuple[str, str], list[Score]],
    modes: Sequence[str],
    relative: bool | None,
) -> tuple[Series, ...]:
    """Values where ``relative`` is None, else deviations from the truth, in per cent or not."""
    names, series = runs.names(run), []
    for mode in modes:
        for i, name in enumerate(names):
            known = [s for s in rows.get((name, mode), []) if s.truth is not None]
            if not known:
                continue
            y, u = column(known, "value"), column(known, "u")
            if relative is not None:
                true = column(known, "truth")
                scale = 100 / np.abs(true) if relative else 1.0
                y, u = (y - true) * scale, u * scale
            style = replace(
                look(run, name), hollow=mode in SHOWN_LEVELS and len(runs.modes(run)) > 1
            )
            x = column(known, "index") + spread(i, len(names))
            bars = u if np.isfinite(u).any() else None
            series.append(Series(name, x, y, style, bars, points=True, line=len(known) > 1))
    return tuple(series)


def column(scores: Sequence[Score], field: str) -> Array:
    """One field of some scores (n,); NaN where there is none."""
    values = [getattr(score, field) for score in scores]
    return np.array([np.nan if value is None else float(value) for value in values])


def _tolerance_band(run: Run, measure: str) -> tuple[Band, ...]:
    """The tolerance of the whole run's value, in per cent of its truth.

    Of several steps, which may have tolerances of their own, the tightest.
    """
    halves = [
        100 * accepted / abs(score.truth)
        for score in run.scores
        if score.measure == measure and score.index is None and score.truth
        if (accepted := runs.width(run, score)) is not None
    ]
    half = min(halves if runs.steps(run) else halves[:1], default=None)
    return () if half is None else (Band(-half, half, "tolerance of the mean", 0.0),)
