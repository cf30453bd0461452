"""Figures of series over an axis of their own, such as a response over frequency."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simcompare.compare.comparison import Score
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import TRUTH, Array
from simcompare.reports.render.figures import (
    MOST_PANELS,
    TRUTH_STYLE,
    Figure,
    Panel,
    Series,
    fitted_range,
)
from simcompare.reports.run import runs
from simcompare.reports.run.score_figures import column, events_of
from simcompare.reports.run.source_styles import look
from simcompare.results.run import Run

#: curves of more points than this are drawn as lines only
_FEW = 40
#: what is only shown may make an axis so many times longer
_FLAT = 3.0
#: units in which a deviation is not taken as a part of the value
_ABSOLUTE = ("deg", "rad", "s")


def axes_drawn(run: Run) -> list[str]:
    """Measures that serve as an axis and were found, in the order of the scenario."""
    found = {score.measure for score in run.scores if score.index is not None}
    return [axis for axis in dict.fromkeys(runs.axes(run).values()) if axis in found]


def over(run: Run, axis: str) -> list[str]:
    """Measures that are drawn over an axis."""
    return [name for name, own in runs.axes(run).items() if own == axis]


def is_answer(run: Run, axis: str) -> bool:
    """Whether an axis is something else than time, so that its curves answer the question."""
    return _unit(run, axis) != "s"


def leading_axis(run: Run) -> str | None:
    """The axis whose curves answer the question, ``None`` where the motion does."""
    return next((axis for axis in axes_drawn(run) if is_answer(run, axis)), None)


def curves_figures(run: Run, axis: str) -> list[Figure]:
    """Everything that is drawn over one axis, one panel each, a few panels a figure."""
    panels = [_values(run, *panel) for panel in _panels(run, axis)]
    true = any(series.style == TRUTH_STYLE for panel in panels for series in panel.series)
    caption = f"The thick grey line is the truth ({TRUTH}). " if true else ""
    hollow = [runs.mode_words(mode) for mode in runs.modes(run) if mode in SHOWN_LEVELS]
    if hollow and len(runs.modes(run)) > 1:
        caption += (
            f"Hollow points are the engines {' or '.join(hollow)},"
            " full ones with all of the physics given."
        )
    if any(panel.y_range is not None for panel in panels):
        caption += " Hollow points far away from all others lie outside."
    return _figures(f"curves-{axis}", f"over {_words(run, axis)}", caption.strip(), panels)


def deviations_figures(run: Run, axis: str) -> list[Figure]:
    """How far every curve over an axis is from the truth; empty where there is no truth."""
    panels = [_deviations(run, *panel) for panel in _panels(run, axis)]
    modes = " and ".join(runs.mode_words(mode) for mode in runs.judged_modes(run))
    return _figures(
        f"deviations-{axis}",
        f"over {_words(run, axis)}: deviation from the truth",
        f"Engines {modes}; an engine that is right runs along zero.",
        [panel for panel in panels if panel.series],
    )


def _panels(run: Run, axis: str) -> list[tuple[str, str, str]]:
    """Axis, measure and level of each panel; two levels that are judged never share one."""
    return [(axis, name, mode) for name in over(run, axis) for mode in runs.judged_modes(run)]


def _title(run: Run, measure: str, mode: str) -> str:
    words = runs.measure_words(measure)
    return f"{words}, {runs.mode_words(mode)}" if len(runs.judged_modes(run)) > 1 else words


def _figures(name: str, ending: str, caption: str, panels: Sequence[Panel]) -> list[Figure]:
    """Panels in as few figures as can be read, as even as possible."""
    count = math.ceil(len(panels) / MOST_PANELS)
    size = math.ceil(len(panels) / max(count, 1))
    found = []
    for i in range(count):
        part = tuple(panels[i * size : (i + 1) * size])
        *others, last = (panel.title for panel in part)
        listed = f"{', '.join(others)} and {last}" if others else last
        title = f"{listed[0].upper()}{listed[1:]} {ending}"
        found.append(Figure(f"{name}-{i + 1}" if i else name, title, caption, part))
    return found


def _values(run: Run, axis: str, measure: str, judged: str) -> Panel:
    rows = events_of(run, measure)
    modes = [mode for mode in runs.modes(run) if mode in SHOWN_LEVELS and mode != judged]
    series = [
        _curve(run, name, mode, (axis, measure), rows.get((name, mode), []))
        for mode in (*modes, judged)
        for name in runs.names(run)
        if rows.get((name, mode))
    ]
    true = _truth(run, axis, measure)
    return Panel(
        _title(run, measure, judged),
        _axis_label(run, axis),
        _label(run, measure),
        (*true, *series),
        log_x=_unit(run, axis) == "Hz",
        y_range=_near_range((*true, *(s for s in series if not s.style.hollow)), series),
    )


def _near_range(near: Sequence[Series], every: Sequence[Series]) -> tuple[float, float] | None:
    """The range of what is judged, where what is only shown would press it flat."""
    own, whole = (fitted_range(tuple(rows), ()) for rows in (near, every))
    return own if near and whole[1] - whole[0] > _FLAT * (own[1] - own[0]) else None


def _deviations(run: Run, axis: str, measure: str, judged: str) -> Panel:
    rows = events_of(run, measure)
    unit = _unit(run, measure)
    found = [score for scores in rows.values() for score in scores if score.truth is not None]
    # a part of a value that passes through zero means nothing
    relative = unit not in _ABSOLUTE and all(score.truth for score in found)
    series = []
    for name in runs.names(run):
        known = [s for s in rows.get((name, judged), []) if s.truth is not None]
        if not known:
            continue
        true = column(known, "truth")
        scale = 100 / np.abs(true) if relative else 1.0
        drawn = _curve(run, name, judged, (axis, measure), known)
        series.append(replace(drawn, y=(column(known, "value") - true) * scale))
    label = "deviation (%)" if relative else f"deviation{runs.unit_words(unit)}"
    return Panel(
        _title(run, measure, judged), _axis_label(run, axis), label, tuple(series),
        log_x=_unit(run, axis) == "Hz",
    )  # fmt: skip


def _curve(
    run: Run, name: str, mode: str, names: tuple[str, str], scores: Sequence[Score]
) -> Series:
    axis, _ = names
    x = _places(run, axis, (name, mode), scores)
    plain = mode in SHOWN_LEVELS and len(runs.modes(run)) > 1
    style = replace(look(run, name), hollow=plain)
    few = len(scores) <= _FEW
    return Series(name, x, column(scores, "value"), style, points=few, line=not (few and plain))


def _truth(run: Run, axis: str, measure: str) -> list[Series]:
    for key, scores in events_of(run, measure).items():
        known = [score for score in scores if score.truth is not None]
        if known:
            x = _places(run, axis, key, known, of="truth")
            return [Series(f"truth ({TRUTH})", x, column(known, "truth"), TRUTH_STYLE)]
    return []


def _places(
    run: Run, axis: str, key: tuple[str, str], scores: Sequence[Score], of: str = "value"
) -> Array:
    """Where on the axis the scores of one source stand; what has no place there is a gap."""
    places = {score.index: getattr(score, of) for score in events_of(run, axis).get(key, [])}
    found = [places.get(score.index) for score in scores]
    return np.array([np.nan if value is None else float(value) for value in found])


def _words(run: Run, axis: str) -> str:
    """What an axis is called; every axis of time has a name of its own in a scenario."""
    return "time" if _unit(run, axis) == "s" else runs.measure_words(axis)


def _axis_label(run: Run, axis: str) -> str:
    return f"{_words(run, axis)}{runs.unit_words(_unit(run, axis))}"


def _label(run: Run, measure: str) -> str:
    return f"{runs.measure_words(measure)}{runs.unit_words(_unit(run, measure))}"


def _unit(run: Run, measure: str) -> str:
    return next((score.unit for score in run.scores if score.measure == measure), "1")
