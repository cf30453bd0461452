"""Tables of scores with their verdicts."""

from __future__ import annotations

from typing import Any

from simcompare.compare.comparison import FAIL, INFO, PASS, Score
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import TRUTH
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import style_of
from simcompare.reports.run import runs
from simcompare.reports.sections.base import Section
from simcompare.results.run import Run
from simcompare.running.jobs import OK

#: never told by colour alone
_VERDICTS = {PASS: "✓ pass", FAIL: "✗ fail", INFO: "· shown"}


class Scores(Section):
    """Every value of a whole run: value ± u, truth, tolerance, verdict."""

    name, title, template = "scores", "Scores", "scores.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """One group of rows for each measure; ``None`` where nothing was measured."""
        measures = runs.measures(run)
        if not measures:
            return None
        return {
            "modes": [
                (runs.mode_words(mode), mode not in SHOWN_LEVELS) for mode in runs.modes(run)
            ],
            "groups": [_group(run, measure) for measure in measures],
            "missing": runs.not_run(run),
            "repeats": run.record.repeats,
            "truth": TRUTH if any(s.truth is not None for s in run.scores) else None,
        }


def _group(run: Run, measure: str) -> dict[str, Any]:
    found = [s for s in run.scores if s.measure == measure and s.index is None]
    first = found[0]
    tolerance = run.record.tolerances.get(measure)
    # at other steps there may be other tolerances
    widths = [runs.width(run, score) for score in (found if runs.steps(run) else [first])]
    accepted = dict.fromkeys(numbers.plain(width, 3) for width in widths if width is not None)
    relative = tolerance.relative if tolerance else None
    return {
        "title": runs.measure_words(measure),
        "unit": runs.unit_words(first.unit),
        "truth": None if first.truth is None else _truth(run, first),
        "tolerance": " or ".join(accepted) or None,
        "relative": None if relative is None else numbers.percent(relative),
        "reason": tolerance.reason if tolerance else None,
        "rows": [_row(run, name, measure) for name in runs.names(run) if _ran(run, name)],
    }


def _truth(run: Run, score: Score) -> str:
    digits = 6 if score.scatter is not None else numbers.digits(score.truth, runs.width(run, score))
    return numbers.with_u(score.truth, None, scale=runs.size(run, score), digits=digits)


def _ran(run: Run, name: str) -> bool:
    sources = run.record.sources
    return any(source.name == name and source.status == OK for source in sources)


def _row(run: Run, name: str, measure: str) -> dict[str, Any]:
    cells = [_cell(run, runs.score_of(run, name, mode, measure)) for mode in runs.modes(run)]
    return {"name": name, "style": style_of(name), "cells": cells}


def _cell(run: Run, score: Score | None) -> dict[str, Any] | None:
    if score is None:
        return None
    deviation = "–"
    if score.value is not None and score.truth is not None:
        size, digits = runs.size(run, score), 6 if score.scatter is not None else 4
        deviation = numbers.with_u(
            score.value - score.truth, score.scatter, scale=size, digits=digits
        )
    return {
        "value": runs.value_words(run, score),
        "deviation": deviation,
        "share": numbers.percent(runs.share_of_tolerance(run, score)),
        "verdict": score.verdict,
        "words": _VERDICTS[score.verdict],
    }
