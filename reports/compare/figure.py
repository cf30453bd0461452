"""The figure of a measure: over the one number in which runs differ, else run by run."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator

import numpy as np

from simcompare.comparison.comparison import Score
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import Array
from simcompare.notation import capital
from simcompare.reports.compare.compared import Compared
from simcompare.reports.compare.differences import Difference
from simcompare.reports.render.figures import Figure, Note, Panel, Series, Span, spread
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.run import runs
from simcompare.reports.run.lead import Lead

_TRUTH_STYLE = Style("#777777", "dash", width=1.5)
#: from the least to the largest x from which on the axis is logarithmic
_WIDE = 20.0
#: letters of a title beside an axis, and how much of its row the engines take
_LETTERS, _SPREAD = 24, 0.8
#: height of an engine in a row, and of the rest of a figure, in usual heights
_ROW, _FRAME, _MIN_HEIGHT, _MAX_HEIGHT = 0.045, 0.34, 0.8, 4.0
#: what stands on both sides of it stays on one line
_TIED = "\u00a0"
#: tolerances over which the truth changes so much that nobody sees how far engines are from it
_HIDDEN = 20.0
#: part of the width of a panel that is left free at its ends
_MARGIN = 0.06


def figure(compared: Compared, measure: str) -> Figure:
    """One panel for each contact level.

    Args:
        compared: the runs.
        measure: what is drawn.
    """
    leads, swept = compared.leads(measure), compared.swept
    caption = _caption(compared, leads)
    if swept is not None:
        panels = tuple(_over(compared, leads, swept, level) for level in compared.levels)
        title = f"{capital(leads[0].words)} over {swept.label}"
        return Figure(f"compare-{measure}", title, f"One line for each engine{caption}", panels)
    panels = tuple(_by_run(compared, leads, level) for level in compared.levels)
    rows = len(compared.runs) * (len(compared.engines) + 1)
    height = min(max(_FRAME + _ROW * rows, _MIN_HEIGHT), _MAX_HEIGHT)
    title, caption = f"{capital(leads[0].words)} in every run", f"One row for each run{caption}"
    return Figure(f"compare-{measure}", title, caption, panels, share_y=True, height=height)


def deviations(compared: Compared, measure: str) -> Figure | None:
    """The same less the truth, level by level that is judged.

    ``None`` where the runs are no sweep, or where the truth changes so little that the figure
    itself shows how far engines are from it.
    """
    leads, swept = compared.leads(measure), compared.swept
    truths = [lead.truth for lead in leads if lead.truth is not None]
    widths = [lead.width for lead in leads if lead.width]
    if swept is None or not widths or max(truths) - min(truths) < _HIDDEN * max(widths):
        return None
    levels = [level for level in compared.levels if level not in SHOWN_LEVELS]
    panels = tuple(_over(compared, leads, swept, level, off=True) for level in levels)
    title = f"{capital(leads[0].words)} less its truth over {swept.label}"
    caption = f"An engine that is right runs along zero{_caption(compared, leads)}"
    return Figure(f"compare-{measure}-off", title, caption, panels) if panels else None


def _caption(compared: Compared, leads: list[Lead]) -> str:
    parts = ["one panel for each contact level"]
    if any(run.record.repeats > 1 for run in compared.runs):
        parts.append("bars are one standard deviation over the repeats")
    if any(lead.is_judged for lead in leads):
        parts.append("the grey band is the tolerance about the truth")
    return f", {'; '.join(parts)}."


# --- over a number ------------------------------------------------------------------------------


def _over(
    compared: Compared, leads: list[Lead], swept: Difference, level: str, *, off: bool = False
) -> Panel:
    """A measure at a level, or how far it is ``off`` the truth."""
    x = np.array([float(value or 0.0) * swept.factor for value in swept.values])
    truth = np.array([np.nan if lead.truth is None else lead.truth for lead in leads])
    base = truth if off else np.zeros(len(x))
    lines = [_line(compared, leads[0], x, base, (name, level)) for name in compared.engines]
    series = tuple(line for line in lines if np.isfinite(line.y).any())
    log = bool(x.min() > 0 and x.max() > _WIDE * x.min())
    label = runs.label(
        f"deviation of {leads[0].measure}" if off else leads[0].measure, leads[0].unit
    )
    shown = (*_truth_curve(leads, x, truth - base), *series)
    return Panel(runs.mode_title(level), swept.head, label, shown, log_x=log)


def _line(compared: Compared, lead: Lead, x: Array, base: Array, source: tuple[str, str]) -> Series:
    scores = [runs.score_of(run, *source, lead.measure) for run in compared.runs]
    y, u, name = _values(scores) - base, _scatters(scores), source[0]
    return Series(name, x, y, style_of(name), u if u.any() else None, points=True)


def _values(scores: list[Score | None]) -> Array:
    known = (None if score is None else score.value for score in scores)
    return np.array([np.nan if value is None else value for value in known])


def _scatters(scores: list[Score | None]) -> Array:
    return np.array([0.0 if score is None else score.scatter or 0.0 for score in scores])


def _truth_curve(leads: list[Lead], x: Array, y: Array) -> tuple[Series, ...]:
    """The truth and the tolerance about it."""
    known = np.isfinite(y)
    if not known.any():
        return ()
    u = np.array([lead.width or 0.0 for lead in leads])[known]
    label = "truth ± tolerance" if u.any() else "truth"
    return (Series(label, x[known], y[known], _TRUTH_STYLE, u, shaded=True),)


# --- run by run ---------------------------------------------------------------------------------


def _by_run(compared: Compared, leads: list[Lead], level: str) -> Panel:
    series = [
        line
        for place, name in enumerate(compared.engines)
        if np.isfinite((line := _dots(compared, leads, place, name, level)).x).any()
    ]
    limits = _limits(leads, series)
    return Panel(
        runs.mode_title(level),
        runs.label(leads[0].measure, leads[0].unit),
        "",
        tuple(series),
        spans=tuple(_spans(leads)),
        y_ticks=tuple(map(_wrapped, compared.titles)),
        x_limits=limits,
        notes=tuple(_empty(compared, series, limits[0])),
    )


def _wrapped(title: str) -> str:
    """A title on short lines; a number stays with its name and unit."""
    pieces = (piece.replace(" ", _TIED) for piece in title.split(", "))
    return "\n".join(textwrap.wrap(", ".join(pieces), _LETTERS)).replace(_TIED, " ")


def _dots(compared: Compared, leads: list[Lead], place: int, name: str, level: str) -> Series:
    """One engine in every run, each in its place of the run's row."""
    scores = [runs.score_of(run, name, level, leads[0].measure) for run in compared.runs]
    rows = np.arange(len(scores), dtype=np.float64) + spread(place, len(compared.engines), _SPREAD)
    x, u = _values(scores), _scatters(scores)
    return Series(name, x, rows, style_of(name), u if u.any() else None, points=True, line=False)


def _spans(leads: list[Lead]) -> Iterator[Span]:
    """The truth of each run and the tolerance about it, as high as its row."""
    for row, lead in enumerate(leads):
        rows = (row - 0.5, row + 0.5)
        if lead.truth is not None:
            if lead.width:
                yield Span(lead.truth - lead.width, lead.truth + lead.width, "tolerance", rows)
            yield Span(lead.truth, lead.truth, "truth", rows)


def _limits(leads: list[Lead], series: list[Series]) -> tuple[float, float]:
    """All values and what is accepted."""
    true = [(lead.truth, lead.width or 0.0) for lead in leads if lead.truth is not None]
    ends = [end for truth, width in true for end in (truth - width, truth + width)]
    for one in series:
        u = np.zeros(len(one.x)) if one.u is None else one.u
        ends += [*(one.x - u), *(one.x + u)]
    known = [end for end in ends if np.isfinite(end)] or [0.0, 1.0]
    low, high = min(known), max(known)
    free = _MARGIN * ((high - low) or abs(high) or 1.0)
    return low - free, high + free


def _empty(compared: Compared, series: list[Series], left: float) -> Iterator[Note]:
    """A dash where no engine has a value in a run."""
    for row in range(len(compared.runs)):
        if not any(np.isfinite(one.x[row]) for one in series):
            yield Note(left, float(row), " – no engine has a value")
