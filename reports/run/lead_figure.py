"""The picture that leads a report: value and scatter of every source and level, at the truth."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare.model.settings import (
    ASSISTED,
    BY_HAND,
    COEFFICIENTS,
    DEFAULT,
    SHOWN_LEVELS,
    TUNED,
)
from simcompare.model.trajectory import TRUTH
from simcompare.notation import capital
from simcompare.reports.render.figures import Figure, Note, Panel, Series, Span, spread
from simcompare.reports.render.styles import Style
from simcompare.reports.run import runs
from simcompare.reports.run.lead import Lead, Row, lead_of
from simcompare.reports.run.lead_rows import rows_of
from simcompare.results.run import Run
from simcompare.running.jobs import OK

#: levels differ by colour, marker and filling, so that each alone tells them
_STYLES = {
    DEFAULT: Style("#555555", marker="circle", hollow=True),
    COEFFICIENTS: Style("#E69F00", marker="x"),
    TUNED: Style("#0072B2", marker="square"),
    ASSISTED: Style("#009E73", marker="diamond"),
    BY_HAND: Style("#882255", marker="star"),
    "fitted": Style("#CC79A7", marker="triangle-up"),
}
#: the panel beside the truth shows at least and at most so many tolerances to either side
_MIN_HALF, _MAX_HALF = 3.0, 15.0
#: the whole shows at most so many times the truth beyond it
_WHOLE = 1.5
#: in place of a value
_DASH = "–"
#: markers at the edge of a panel
_ARROWS = {True: "triangle-left", False: "triangle-right"}
#: part of a panel's width that is left free at its ends
_MARGIN = 0.05
#: bars below this part of a panel's width are hidden by their point
_SHORT = 0.005
#: how much of its row the levels of a source take
_SPREAD = 0.8
#: height of a row that holds one level, and of the rest of a figure, in usual heights
_ROW, _FRAME = 0.032, 0.34
_MIN_HEIGHT, _MAX_HEIGHT = 0.8, 3.0


@dataclass(frozen=True)
class _Scale:
    """The part of the axis that a panel shows.

    Attributes:
        title: of the panel.
        low: left end.
        high: right end.
    """

    title: str
    low: float
    high: float

    def holds(self, value: float) -> bool:
        """Whether a value can be drawn."""
        return self.low <= value <= self.high

    @property
    def free(self) -> float:
        """A little of the width."""
        return (self.high - self.low) * _MARGIN / 2


def lead_figure(run: Run) -> Figure | None:
    """One row for each source; ``None`` where nothing was measured."""
    lead = lead_of(run)
    if lead is None:
        return None
    by_mode = {mode: rows_of(run, lead, mode) for mode in runs.modes(run)}
    known = {mode: rows for mode, rows in by_mode.items() if rows}
    values = [row.value for rows in known.values() for row in rows if row.value is not None]
    near = _near(lead, known)
    full = _full(lead, values)
    scales = [scale for scale in (full, near) if scale is not None]
    if near is not None and all(near.holds(value) for value in values):
        scales = [near]
    panels = tuple(_panel(run, lead, by_mode, scale, i) for i, scale in enumerate(scales))
    caption = _caption(run, lead, panels)
    if len(panels) == 1:  # a name tells panels apart
        panels = (replace(panels[0], title=""),)
    rows = len(runs.names(run)) * (len(by_mode) + 0.6)
    height = min(max(_FRAME + _ROW * rows, _MIN_HEIGHT), _MAX_HEIGHT)
    title = f"{capital(lead.words)} in every engine"
    return Figure("answer", title, caption, panels, True, height)


def _near(lead: Lead, rows: dict[str, list[Row]]) -> _Scale | None:
    """The neighbourhood of the truth, as wide as what is judged needs."""
    if lead.truth is None or not lead.width:
        return None
    width = max(lead.widths)
    judged = [mode for mode in rows if mode not in SHOWN_LEVELS] or list(rows)
    values = [row.value for mode in judged for row in rows[mode] if row.value is not None]
    offs = [abs(value - lead.truth) for value in values]
    inside = [1.25 * off for off in offs if off <= _MAX_HALF * width]
    half = max([_MIN_HALF * width, *inside])
    return _Scale("near the truth", lead.truth - half, lead.truth + half)


def _full(lead: Lead, values: Sequence[float]) -> _Scale:
    """All values and the truth; what is very far is left to arrows."""
    true = [] if lead.truth is None else [lead.truth, 0.0]
    size = max(abs(lead.truth or 0.0), 100 * (lead.width or 0.0))
    kept = [v for v in values if lead.truth is None or abs(v - lead.truth) <= _WHOLE * size]
    ends = [*kept, *true] or [0.0]
    low, high = min(ends), max(ends)
    margin = _MARGIN * ((high - low) or abs(high) or 1.0)
    return _Scale("the whole", low - margin, high + margin)


def _panel(run: Run, lead: Lead, by_mode: dict[str, list[Row]], scale: _Scale, place: int) -> Panel:
    names = runs.names(run)
    # beside the truth only what is judged: all else has its place on the left
    modes = [mode for mode in by_mode if place == 0 or mode not in SHOWN_LEVELS] or list(by_mode)
    series: list[Series] = []
    notes: list[Note] = []
    drawn = {row.name for mode in modes for row in by_mode[mode]}
    left = scale.low + scale.free
    for mode in modes:
        shift = spread(list(by_mode).index(mode), len(by_mode), _SPREAD)
        at = {row.name: row for row in by_mode[mode]}
        places = [(i + shift, at[name]) for i, name in enumerate(names) if name in at]
        made, beside = _drawn(lead, mode, places, scale)
        series += made
        notes += beside
        notes += [
            Note(left, i + shift, _missing(run, name, [mode]), colour=_style(mode).colour)
            for i, name in enumerate(names)
            if name in drawn and name not in at
        ]
    notes += [
        Note(left, float(i), _missing(run, name, modes))
        for i, name in enumerate(names)
        if name not in drawn
    ]
    label = runs.label(lead.measure, lead.unit)
    return Panel(
        scale.title, label, "", tuple(series), spans=_truth(run, lead), y_ticks=tuple(names),
        x_limits=(scale.low, scale.high), notes=tuple(notes), weight=1.0 if place == 0 else 1.3,
    )  # fmt: skip


def _drawn(
    lead: Lead, mode: str, places: Sequence[tuple[float, Row]], scale: _Scale
) -> tuple[list[Series], list[Note]]:
    """Points of one level with their scatter; arrows at the edge and dashes where there is none."""
    style = _style(mode)
    inside, arrows, notes = [], [], []
    for y, row in places:
        if row.value is None and row.ends is not None and scale.holds(sum(row.ends) / 2):
            low, high = row.ends
            inside.append(((low + high) / 2, y, (high - low) / 2))
            continue
        if row.value is None:
            notes.append(Note(scale.low + scale.free, y, lead.ends(row), colour=style.colour))
            continue
        if scale.holds(row.value):
            inside.append((row.value, y, row.scatter or 0.0))
            continue
        left = row.value < scale.low
        edge = scale.low + scale.free if left else scale.high - scale.free
        arrows.append((edge, y, left))
        text, side = lead.text(row.value), "right" if left else "left"
        inner = edge + scale.free * (1 if left else -1)
        notes.append(Note(inner, y, text, side, style.colour))
    made = _points(mode, style, inside, scale) if inside else []
    for left in (True, False):
        ends = [(x, y, 0.0) for x, y, one in arrows if one == left]
        if ends:
            arrow = replace(style, marker=_ARROWS[left])
            made += _points(mode, arrow, ends, scale)
    return made, notes


def _style(mode: str) -> Style:
    return _STYLES.get(mode, Style("#882255", marker="star"))


def _points(
    mode: str, style: Style, rows: Iterable[tuple[float, float, float]], scale: _Scale
) -> list[Series]:
    """Points with their scatter, and points whose scatter is too small to be seen."""
    x, y, u = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    # the ends of a bar that is no longer than its point would lie across it
    short = u < _SHORT * (scale.high - scale.low)
    label = runs.mode_words(mode)
    return [
        Series(label, x[chosen], y[chosen], style, bars, points=True, line=False)
        for chosen, bars in ((~short, u[~short]), (short, None))
        if chosen.any()
    ]


def _truth(run: Run, lead: Lead) -> tuple[Span, ...]:
    """The truth and the tolerance about it; of each row where sources have their own."""
    if lead.truth is None:
        return ()
    line = Span(lead.truth, lead.truth, f"truth ({TRUTH})")
    if len(lead.widths) < 2:
        return (*(_tolerance(lead.truth, width) for width in lead.widths), line)
    scores = {
        s.source: s for s in run.record.scores if (s.measure, s.index) == (lead.measure, None)
    }
    widths = [runs.width(run, scores[name]) if name in scores else None for name in runs.names(run)]
    bands = [
        _tolerance(lead.truth, width, (i - 0.5, i + 0.5))
        for i, width in enumerate(widths)
        if width is not None
    ]
    return (*bands, line)


def _tolerance(truth: float, width: float, rows: tuple[float, float] | None = None) -> Span:
    return Span(truth - width, truth + width, "tolerance", rows)


def _missing(run: Run, name: str, modes: Sequence[str]) -> str:
    """What became of a source that did not run at these levels."""
    states = {s.status for s in run.record.sources if s.name == name and s.contact in modes} - {OK}
    return f"{_DASH} {', '.join(sorted(states))}".strip()


def _caption(run: Run, lead: Lead, panels: Sequence[Panel]) -> str:
    parts = ["One row for each engine, one symbol for each level"]
    repeats = run.record.repeats
    if repeats > 1:
        parts.append(
            f"bars are one standard deviation over {repeats} repeats,"
            " where it is more than the symbol is wide"
        )
    if any(row.value is None and row.ends for mode in runs.modes(run)
           for row in rows_of(run, lead, mode)):  # fmt: skip
        parts.append(
            "where only some repeats could be measured, from their lowest to their highest"
        )
    text = f"{'; '.join(parts)}."
    if lead.of_events:
        text += f" The {lead.words} is the mean over all events of a repeat."
    if len(panels) > 1:
        text += f" The panel “{panels[-1].title}” shows what is judged, and the tolerance."
    if len(lead.widths) > 1:
        text += " Each row has its own tolerance."
    if any(row.style.marker in _ARROWS.values() for panel in panels for row in panel.series):
        text += " Arrows at an edge point to values beyond it."
    if any(note.text == _DASH for panel in panels for note in panel.notes):
        text += " – could not be measured."
    return text
