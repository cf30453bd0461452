"""The answer, the one key picture, and every engine in one line."""

from __future__ import annotations

from simcompare.comparison.comparison import FAIL, PASS
from simcompare.model.settings import DEFAULT, SHOWN_LEVELS, TUNED
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, Table, of_engines
from simcompare.reports.run import (
    answer,
    by_step,
    curve_figures,
    motion_figures,
    not_run,
    remarks,
    runs,
)
from simcompare.reports.run.key_numbers import key_numbers
from simcompare.reports.run.lead import Lead, lead_of
from simcompare.reports.run.lead_figure import lead_figure
from simcompare.reports.run.short import short
from simcompare.results.records.run import SourceRecord
from simcompare.results.run import Run

#: never told by colour alone
_MARKS = {PASS: " ✓", FAIL: " ✗"}


def headline(run: Run) -> Part:
    """Answer, leading picture, motion, and a scoreboard."""
    lead = lead_of(run)
    figures = (figure for figure in _figures(run, lead) if figure is not None)
    missing = Part(tables=not_run.tables(run), brief=False)  # told in "How it was made" as well
    return Part("Answer", "answer", short=short(run), key_numbers=key_numbers(run),
                answer=tuple(answer.sentences(run)), figures=tuple(figures),
                remarks=tuple(remarks.remarks(run)), tables=(_scoreboard(run, lead),),
                parts=(missing,))  # fmt: skip


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


def _scoreboard(run: Run, lead: Lead | None) -> Table:
    """Every engine in one row: the leading measure at each level, and what was met."""
    over = runs.label(lead.measure, lead.unit) if lead else ""
    columns = [Column(runs.mode_words(mode), over=over) for mode in runs.modes(run)]
    columns += [Column("Tolerances met", text=True), Column("Version", text=True)]
    return of_engines(columns, [Group("", tuple(_row(run, n, lead) for n in runs.names(run)))])


def _row(run: Run, name: str, lead: Lead | None) -> tuple[str, ...]:
    modes = runs.modes(run)
    sources = [runs.source_of(run, name, mode) for mode in modes]
    values = [_value(run, source, lead) for source in sources]
    met = [_met(run, name, source.contact) for source in sources if source and source.ran]
    version = next((source.version for source in sources if source and source.version), None)
    return name, *values, " ".join(filter(None, met)) or "· not judged", version or ""


def _value(run: Run, source: SourceRecord | None, lead: Lead | None) -> str:
    if source is None:
        return "was not asked for"
    if not source.ran:
        return source.status
    score = runs.score_of(run, source.name, source.contact, lead.measure) if lead else None
    mark = _MARKS.get(score.verdict, "") if score else ""
    return f"{runs.value_words(run, score)}{mark}"


def _met(run: Run, name: str, mode: str) -> str:
    """How many tolerances were met at a level; empty where nothing is judged there."""
    met, of = runs.passed(run, name, mode)
    if mode in SHOWN_LEVELS or not of:
        return ""
    every = len(runs.judged(run))
    text = f"{'✓' if met == every else '✗'} {runs.mode_words(mode)} {met} of {every}"
    return text.replace(" ", "\u00a0")
