"""Sections that hold figures and no more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Part
from simcompare.reports.run import curve_figures, drive_figure, motion_figures, runs
from simcompare.reports.run.contrast_figure import contrast_figure
from simcompare.reports.run.range_pictures import range_figures
from simcompare.reports.run.replay import replay_of
from simcompare.results.run import Run

#: so many signals are seen at once, the others on request
_OPEN = 2
#: more energy than this part of that at the start is worth a name
_GAIN = 1.001


def moving(run: Run) -> Part | None:
    """The scene in three dimensions; ``None`` where no source tells where a body is."""
    replay = replay_of(run)
    return None if replay is None else Part(replay.title, "replay", replays=(replay,), brief=False)


def ranges(run: Run) -> Part | None:
    """What range sensors saw; ``None`` where there are none."""
    figures = range_figures(run)
    return Part("What it saw", "ranges", figures=figures, brief=False) if figures else None


def curves(run: Run) -> Part | None:
    """Series over an axis of their own, such as a response over frequency.

    The figure that leads the report is not drawn a second time.
    """
    axes = curve_figures.axes_drawn(run)
    leading = curve_figures.leading_axis(run)
    figures = [
        figure
        for axis in axes
        for figure in curve_figures.curves_figures(run, axis)[1 if axis == leading else 0 :]
    ]
    for axis in axes:
        figures += curve_figures.deviations_figures(run, axis)
    more = f"; and {len(figures) - _OPEN} more" if len(figures) > _OPEN else ""
    words = "; ".join(figure.title for figure in figures[:_OPEN]) + more
    return _folded("Further curves", "curves", tuple(figures), words) if figures else None


def drive(run: Run) -> Part | None:
    """What drove the scene; open where it varies, ``None`` where nothing did."""
    figure = drive_figure.drive_figure(run)
    if figure is None:
        return None
    every = drive_figure.drives(run)
    part = _folded("What drove it", "drive", (figure,), "; ".join(one.words for one in every))
    return replace(part, folded=all(one.is_constant for one in every))


def energy(run: Run) -> Part | None:
    """Where the energy goes; ``None`` where the scenario does not tell what it takes."""
    figure = motion_figures.energy_figure(run)
    if figure is None:
        return None
    highest = max(
        (float(np.nanmax(one.y)), one.label, panel.title)
        for panel in figure.panels
        for one in panel.series
        if np.isfinite(one.y).any()
    )
    share, source, level = highest
    where = f", in {source} {level}" if share > _GAIN else " anywhere"
    finding = f"at most {numbers.percent(share)} of that at the start{where}"
    return _folded("Energy", "energy", (figure,), finding)


def contrast(run: Run) -> Part | None:
    """All judged scores of all engines at a glance; ``None`` where nothing has a truth."""
    figure = contrast_figure(run)
    if figure is None:
        return None
    return _folded("Deviation in tolerances", "contrast", (figure,), "every measure at a glance")


def signals(run: Run) -> Part | None:
    """Every probe at every level, over time; ``None`` where there is none."""
    probes = list(runs.probes(run).items())
    if len(runs.modes(run)) == 1 and not curve_figures.leading_axis(run):
        probes = probes[1:]  # the whole of the first is in the answer
    if not probes:
        return None
    every = [probe.label for _, probe in probes]
    figures = tuple(motion_figures.probe_figure(run, name, probe) for name, probe in probes)
    rest = figures[_OPEN:]
    words = "; ".join(figure.title.removesuffix(" over time") for figure in rest)
    more = f" and {len(every) - _OPEN} more" if rest else ""
    finding = f"{', '.join(every[:_OPEN])}{more}"
    part = _folded("Over time", "signals", figures[:_OPEN], finding)
    return replace(part, parts=others(words, rest))


def _folded(title: str, name: str, figures: tuple[Figure, ...], finding: str) -> Part:
    return Part(title, name, figures=figures, folded=True, finding=finding)


def others(words: str, figures: tuple[Figure, ...]) -> tuple[Part, ...]:
    """Figures of the same kind as those above them, folded away; none where there are none."""
    return (Part(f"The same for {words}", figures=figures, folded=True),) if figures else ()
