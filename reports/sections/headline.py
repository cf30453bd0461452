"""The answer, the one key picture, and every engine in one line."""

from __future__ import annotations

from typing import Any

from simcompare.compare.comparison import FAIL, PASS
from simcompare.model.settings import DEFAULT, SHOWN_LEVELS, TUNED
from simcompare.reports.render.figures import Figure, style_of
from simcompare.reports.run import answer, by_step, curve_figures, motion_figures, remarks, runs
from simcompare.reports.run.lead import Lead, lead_of
from simcompare.reports.run.lead_figure import lead_figure
from simcompare.reports.sections.base import Section
from simcompare.results.run import Run
from simcompare.running.jobs import OK

#: never told by colour alone
_MARKS = {PASS: "✓", FAIL: "✗"}


class Headline(Section):
    """Question, answer and key picture."""

    name, title, template = "answer", "Answer", "headline.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Answer, leading picture, motion, and a scoreboard."""
        found = lead_of(run)
        lead = found.measure if found else None
        return {
            "question": run.record.question,
            "answer": answer.sentences(run),
            "remarks": remarks.remarks(run),
            "figures": [figure for figure in _figures(run, found) if figure is not None],
            "modes": [runs.mode_words(mode) for mode in runs.modes(run)],
            "lead": runs.measure_words(lead) if lead else None,
            "lead_unit": _unit(run, lead),
            "missing": runs.not_run(run),
            "rows": [_row(run, name, lead) for name in runs.names(run)],
        }


def _figures(run: Run, lead: Lead | None) -> tuple[Figure | None, ...]:
    """The leading measure over the step where there are several, and level by level; the motion."""
    if lead is not None and runs.steps(run):
        return by_step.figure(run, lead), lead_figure(run)
    return lead_figure(run), _second_figure(run)


def _second_figure(run: Run) -> Figure | None:
    """A curve over something else than time, which answers more than its making; else the motion.

    The motion is shown as the engines have it by themselves: as they come, and tuned.
    """
    axis = curve_figures.leading_axis(run)
    if axis is not None:
        return next(iter(curve_figures.curves_figures(run, axis)), None)
    probes = list(runs.probes(run).items())
    if not probes:
        return None
    shown = [mode for mode in (DEFAULT, TUNED) if mode in runs.modes(run)]
    modes = shown if TUNED in shown else runs.judged_modes(run)[-1:]
    return motion_figures.motion_figure(run, *probes[0], modes)


def _row(run: Run, name: str, lead: str | None) -> dict[str, Any]:
    cells: list[dict[str, Any]] = []
    version = None
    for mode in runs.modes(run):
        source = runs.source_of(run, name, mode)
        if source is None:
            cells.append({"reason": "was not asked for"})
            continue
        version = version or source.version
        if source.status != OK:
            cells.append({"status": source.status, "reason": source.reason})
            continue
        met, of = runs.passed(run, name, mode)
        score = runs.score_of(run, name, mode, lead) if lead else None
        cells.append(
            {
                "value": runs.value_words(run, score),
                "mark": _MARKS.get(score.verdict, "") if score else "",
                "mode": runs.mode_words(mode),
                "met": None if mode in SHOWN_LEVELS or not of else met,
                "of": len(runs.judged(run)),
            }
        )
    return {"name": name, "version": version, "style": style_of(name), "cells": cells}


def _unit(run: Run, lead: str | None) -> str:
    for score in run.scores:
        if score.measure == lead:
            return runs.unit_words(score.unit)
    return ""
