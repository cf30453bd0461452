"""How the leading measure changes with the step: engine by engine, in words and as a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from simcompare.comparison.repeats import step_words
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import AT, TRUTH
from simcompare.notation import capital
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.run import runs
from simcompare.reports.run.lead import MIXED, OUTSIDE, WITHIN, Lead, Row
from simcompare.reports.run.lead_rows import rows_of
from simcompare.reports.run.level_phrases import how
from simcompare.reports.run.listing import engines, grouped, joined
from simcompare.results.records.run import StepRecord
from simcompare.results.run import Run

#: behind a value that is outside of its tolerance
_MISSED = " ✗"
_TRUTH_STYLE = Style("#777777", "dash", width=1.5)

At = tuple[float, Row]


def lines(run: Run, lead: Lead, mode: str) -> list[str]:
    """A head, and for each engine its values in the order of the steps; those alike on one line."""
    by_engine = _by_engine(run, lead, mode)
    if not by_engine:
        return []
    judged = mode not in SHOWN_LEVELS and lead.truth is not None
    texts = grouped((_values(lead, steps, judged), engine) for engine, steps in by_engine.items())
    ends = [f"{engines(names, list(by_engine))}: {text}" for text, names in texts.items()]
    return [_head(run, lead, mode, judged=judged), *ends]


def over_steps(run: Run, lead: Lead, rows: Sequence[Row], *, each: bool, first: bool) -> str:
    """The leading measure of all engines over the steps, as half a sentence.

    Args:
        run: the run.
        lead: the leading measure.
        rows: of the engines at each of their steps.
        each: whether each step is told, else where it is right.
        first: whether it is told what it is, and the truth.
    """
    rows = [replace(row, scatter=None) for row in rows]
    at = {_at(step): [row for row in rows if row.name.endswith(step.at)] for step in _steps(run)}
    told = [f"{lead.range_of(some)} at {step}" for step, some in at.items()]
    values = ", ".join(told) if each else lead.range_of(rows) + _right(lead, rows, at)
    if not first:
        return values
    beside = f" ({TRUTH} {lead.true})" if lead.truth else ""
    return f"the {lead.words} is {values}{beside}"


def _right(lead: Lead, rows: Sequence[Row], at: Mapping[str, Sequence[Row]]) -> str:
    """Up to which step all engines are right, else in how many cases."""
    if not lead.is_judged:
        return ""
    right = [step for step, some in at.items() if all(row.kind == WITHIN for row in some)]
    wrong = [step for step, some in at.items() if all(row.kind != WITHIN for row in some)]
    if right and [*right, *wrong] == [*at]:
        return f", right up to {right[-1]}"
    return f", right in {sum(row.kind == WITHIN for row in rows)} of {len(rows)} cases"


def _at(step: StepRecord) -> str:
    return f"{step.at.removeprefix(AT).removesuffix('ms')} ms"


def _values(lead: Lead, steps: Sequence[At], judged: bool) -> str:
    """What an engine has at its steps, once where that is everywhere the same."""
    values = [_value(lead, at, judged) for at in steps]
    same = len(set(values)) == 1 and len(values) > 1
    return f"{values[0]} at every step" if same else ", ".join(values)


def figure(run: Run, lead: Lead) -> Figure | None:
    """The leading measure over the step, one line for each engine, one panel for each level."""
    if not runs.steps(run):
        return None
    every = (_panel(run, lead, mode) for mode in runs.judged_modes(run))
    panels = tuple(panel for panel in every if panel.series)
    if not panels:
        return None
    caption = "One line for each engine"
    if run.record.repeats > 1:
        caption += f"; bars are one standard deviation over {run.record.repeats} repeats"
    if lead.is_judged:
        caption += "; the band is the tolerance at each step"
    title = f"{capital(lead.words)} over the step"
    return Figure("answer-steps", title, f"{caption}.", panels)


def _head(run: Run, lead: Lead, mode: str, *, judged: bool) -> str:
    each = widths(run, lead)
    steps = joined([step.removesuffix("ms") for step, _ in each])
    truth = f", where the {TRUTH} gives {lead.true}" if lead.truth is not None else ""
    mean = " (mean over all events of a repeat)" if lead.of_events else ""
    text = f"{how(run, mode)} {lead.words}{mean} at steps of {steps} ms{truth}"
    if judged and lead.width is not None:
        accepted = [numbers.plain(width, 2) for _, width in each]
        shown = accepted[:1] if len(set(accepted)) == 1 else accepted
        text += f" ({_MISSED.strip()} is off by more than {joined(shown)})"
    return f"{text}:"


def tolerances(run: Run, lead: Lead) -> str:
    """The tolerance at each of several steps, once for those that follow each other with it."""
    known = [(_at(step), width) for step in _steps(run) if (width := _width(run, lead, step))]
    groups = [
        (text, [step for step, _ in group])
        for text, group in groupby(known, lambda one: numbers.plain(one[1], 2))
    ]
    if len(groups) < 2:
        return lead.accepted
    if len(groups) == len(known):
        return ", ".join(f"{text} at {step}" for text, (step,) in groups)
    *most, (last, _) = groups
    return ", ".join([*(f"{text} up to {steps[-1]}" for text, steps in most), f"{last} above"])


def widths(run: Run, lead: Lead) -> list[tuple[str, float | None]]:
    """Each of several steps, as it is typed, with its tolerance."""
    return [(step_words(step.engine_step_s), _width(run, lead, step)) for step in _steps(run)]


def _value(lead: Lead, at: At, judged: bool) -> str:
    _, row = at
    text = lead.ends(row) if row.kind == MIXED else lead.range_of([row])
    return text + (_MISSED if judged and row.kind == OUTSIDE else "")


def _by_engine(run: Run, lead: Lead, mode: str) -> dict[str, list[At]]:
    """What each engine has of the leading measure, at each of its steps from the shortest on."""
    sources = {source.name: source for source in run.record.sources if source.contact == mode}
    rows = [(sources[row.name], row) for row in rows_of(run, lead, mode)]
    groups = grouped((s.engine or s.name, (s.engine_step_s or 0.0, row)) for s, row in rows)
    return {engine: sorted(steps, key=lambda at: at[0]) for engine, steps in groups.items()}


def _steps(run: Run) -> list[StepRecord]:
    return sorted(runs.steps(run), key=lambda step: step.engine_step_s)


def _width(run: Run, lead: Lead, step: StepRecord) -> float | None:
    """The tolerance at a step."""
    widths = (
        runs.width(run, score)
        for score in run.record.scores
        if score.measure == lead.measure and score.index is None and score.source.endswith(step.at)
    )
    return next((width for width in widths if width is not None), None)


def _panel(run: Run, lead: Lead, mode: str) -> Panel:
    series = [
        _line(engine, [at for at in steps if at[1].value is not None])
        for engine, steps in _by_engine(run, lead, mode).items()
    ]
    series = [one for one in series if len(one.x)]
    return Panel(
        runs.mode_title(mode), "step (ms)", runs.label(lead.measure, lead.unit),
        (*(_truth(run, lead) if series else ()), *series), log_x=True,
    )  # fmt: skip


def _line(engine: str, steps: list[At]) -> Series:
    x, y, u = (
        np.array(column, dtype=float)
        for column in (
            [1e3 * step_s for step_s, _ in steps],
            [row.value for _, row in steps],
            [row.scatter or 0.0 for _, row in steps],
        )
    )
    return Series(engine, x, y, style_of(engine), u if u.any() else None, points=True)


def _truth(run: Run, lead: Lead) -> tuple[Series, ...]:
    """The truth, with the tolerance at each step about it."""
    if lead.truth is None:
        return ()
    x = np.array([1e3 * step.engine_step_s for step in _steps(run)])
    u = np.array([_width(run, lead, step) or 0.0 for step in _steps(run)])
    label = f"truth ({TRUTH}) ± tolerance" if u.any() else f"truth ({TRUTH})"
    return (Series(label, x, x * 0 + lead.truth, _TRUTH_STYLE, u, shaded=True),)
