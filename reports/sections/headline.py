"""The answer, the one key picture, and every engine in one line."""

from __future__ import annotations

from typing import Any

from simcompare.jobs import OK
from simcompare.reports import curves, runs, timelines, words
from simcompare.reports.figures import style_of
from simcompare.reports.sections.base import Section
from simcompare.results import Run
from simcompare.settings import SHOWN_LEVELS


class Headline(Section):
    """Question, answer and key picture."""

    name, title, template = "answer", "Answer", "headline.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Answer, figure of the leading probe, and a scoreboard."""
        leading = list(runs.probes(run).items())[:1]
        figures = [timelines.probe_figure(run, name, probe) for name, probe in leading]
        over = [axis for axis in curves.axes_drawn(run) if curves.is_answer(run, axis)]
        if over:  # a curve over something else than time answers more than its making
            figures = curves.curves_figures(run, over[0])[:1]
        judged = runs.judged(run)
        measures = judged or runs.measures(run)
        lead = measures[0] if measures else None
        return {
            "question": run.record["question"],
            "answer": words.answer(run),
            "figures": figures,
            "modes": [runs.mode_words(mode) for mode in runs.modes(run)],
            "lead": runs.measure_words(lead) if lead else None,
            "lead_unit": _unit(run, lead),
            "rows": [_row(run, name, lead) for name in runs.names(run)],
        }


def _row(run: Run, name: str, lead: str | None) -> dict[str, Any]:
    cells: list[dict[str, Any]] = []
    version = None
    for mode in runs.modes(run):
        source = runs.source_of(run, name, mode)
        if source is None:
            cells.append({"reason": "was not asked for"})
            continue
        version = version or source["version"]
        if source["status"] != OK:
            cells.append({"status": source["status"], "reason": source["reason"]})
            continue
        met, of = runs.passed(run, name, mode)
        cells.append(
            {
                "value": runs.value_words(
                    run, runs.score_of(run, name, mode, lead) if lead else None
                ),
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
