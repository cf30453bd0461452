"""How the sources of one run look beside each other, where an engine has several of them."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simcompare.engine import engines
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import AT, Array
from simcompare.reports.render.figures import Series
from simcompare.reports.render.styles import PATTERNS, Style, style_of, with_pattern
from simcompare.reports.run import runs
from simcompare.results.run import Run

#: of an entry that stands for all engines at a level
HOLLOW_STYLE = Style("#555555", hollow=True)


def look(run: Run, source: str) -> Style:
    """The look of a source in all figures of a run.

    An engine looks the same in every report. Its steps have its colour and its variants a shade of
    it, each with a dash and a marker that no other source of the run has, as far as there are
    enough of them.
    """
    return looks(tuple(runs.names(run)))[source]


def level_look(run: Run, source: str, mode: str) -> Style:
    """The same at one level: hollow where that is shown beside others and not judged."""
    hollow = mode in SHOWN_LEVELS and len(runs.modes(run)) > 1
    return replace(look(run, source), hollow=hollow)


def hollow_entries(run: Run, x: Array) -> tuple[Series, ...]:
    """What hollow points are, as entries of a legend; they draw nothing at places ``x``."""
    shown = [mode for mode in runs.modes(run) if mode in SHOWN_LEVELS]
    nothing = np.full(len(x), np.nan)
    return tuple(
        Series(runs.mode_words(mode), x, nothing, HOLLOW_STYLE, points=True, line=False)
        for mode in (shown if len(runs.modes(run)) > 1 else [])
    )


@functools.cache
def looks(sources: tuple[str, ...]) -> dict[str, Style]:
    """The look of each of some sources that are drawn together."""
    styles = {source: style_of(source) for source in sources if _is_plain(source)}
    for source in (source for source in sources if source not in styles):
        styles[source] = _free(style_of(source), [*styles.values()])
    return styles


def _is_plain(source: str) -> bool:
    return AT not in source and engines.VARIANT not in source


def _free(style: Style, taken: Sequence[Style]) -> Style:
    """The style with the first free dash and marker; with a marker of its own where there is one.

    It is looked for from the style's own on.
    """
    first = next(i for i in range(PATTERNS) if with_pattern(style, i) == style)
    each = [with_pattern(style, first + i) for i in range(PATTERNS)]
    markers = {other.marker for other in taken}
    pairs = {(other.dash, other.marker) for other in taken}
    free = [one for one in each if (one.dash, one.marker) not in pairs]
    return next((one for one in free if one.marker not in markers), [*free, style][0])
