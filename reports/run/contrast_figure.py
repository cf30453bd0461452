"""All that was judged at a glance: deviations in tolerances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from simcompare.comparison.comparison import FAIL
from simcompare.model.trajectory import Array
from simcompare.reports.render.figures import Band, Figure, Panel, Series, spread
from simcompare.reports.run import runs
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

#: smaller deviations, in tolerances, are drawn here; a logarithm has no zero
MIN_SHARE = 1e-3


def contrast_figure(run: Run) -> Figure | None:
    """One panel for each level; ``None`` where nothing has a truth."""
    measures = runs.judged(run)
    if not measures:
        return None
    panels = [_panel(run, mode) for mode in runs.modes(run)]
    highest = max((float(np.nanmax(s.y)) for p in panels for s in p.series), default=1.0)
    y_range = (0.6 * MIN_SHARE, 2 * max(highest, 3.0))
    band = Band(y_range[0], 1.0, "within tolerance")
    return Figure(
        "contrast",
        "Deviation from the truth, in tolerances",
        "Lower is better; below 1, in the shaded band, is within the scenario's tolerance. The"
        " scale is logarithmic and ends at a thousandth: smaller deviations are drawn there."
        + _missed(run),
        tuple(replace(panel, bands=(band,), y_range=y_range) for panel in panels),
        share_y=True,
    )


def _panel(run: Run, mode: str) -> Panel:
    names = runs.names(run)
    series = tuple(
        Series(name, x, y, look(run, name), points=True, line=False)
        for i, name in enumerate(names)
        for x, y in [_shares(run, name, mode, spread(i, len(names)))]
        if np.isfinite(y).any()
    )
    ticks = tuple(runs.measure_words(name).replace(" ", "\n") for name in runs.judged(run))
    label = "deviation ÷ tolerance"
    return Panel(runs.mode_title(mode), "", label, series, x_ticks=ticks, log_y=True)


def _shares(run: Run, name: str, mode: str, shift: float) -> tuple[Array, Array]:
    scores = [runs.score_of(run, name, mode, measure) for measure in runs.judged(run)]
    shares = [None if score is None else runs.share_of_tolerance(run, score) for score in scores]
    y = np.array([np.nan if share is None else max(share, MIN_SHARE) for share in shares])
    return np.arange(len(shares), dtype=float) + shift, y


def _missed(run: Run) -> str:
    """What failed without a value that could be drawn."""
    missed = sorted({
        f"{runs.measure_words(score.measure)} in {score.source}, {runs.mode_words(score.contact)}"
        for score in run.record.scores
        if score.index is None and score.measure in runs.judged(run)
        and score.value is None and score.verdict == FAIL
    })  # fmt: skip
    if not missed:
        return ""
    return f" Missed, and not drawn, since not every repeat has it: {'; '.join(missed)}."
