"""The answer, the one key picture, and every engine in one line."""

from __future__ import annotations

from simcompare import glossary
from simcompare.comparison.comparison import FAIL, PASS
from simcompare.model.settings import DEFAULT, SHOWN_LEVELS, TUNED
from simcompare.notation import capital
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, Table
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
from simcompare.reports.run.lead_table import lead_table, legend_words
from simcompare.reports.run.short import short
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
                remarks=tuple(remarks.remarks(run)), tables=tuple(filter(None, [_table(run)])),
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


def _table(run: Run) -> Table | None:
    """The leading measure of every engine at each level, how much was met, and the words of it."""
    table = lead_table(run, marks=_MARKS)
    if table is None:
        return None
    cells = "".join(cell for group in table.groups for row in group.rows for cell in row)
    signs = [
        f"{mark.strip()}: {glossary.term(word).short}"
        for word, mark in _MARKS.items()
        if mark in cells
    ]
    notes = [table.note.removesuffix("."), *glossary.legend(legend_words([table])), *signs]
    return _with_met(run, table)._replace(
        title=capital(table.title), note=f"{'. '.join(filter(None, notes))}."
    )


def _with_met(run: Run, table: Table) -> Table:
    """The same with how many tolerances each engine met, where anything is judged."""
    (group,) = table.groups
    met = {name: _met_by(run, name) for name in runs.names(run)}
    if not any(met.values()):
        return table
    rows = tuple((*row, met.get(row[0], "")) for row in group.rows)
    columns = (*table.columns, Column("tolerances met", text=True))
    return table._replace(columns=columns, groups=(Group("", rows),))


def _met_by(run: Run, name: str) -> str:
    sources = (runs.source_of(run, name, mode) for mode in runs.modes(run))
    return " ".join(_met(run, name, one.contact) for one in sources if one and one.ran).strip()


def _met(run: Run, name: str, mode: str) -> str:
    """How many tolerances were met at a level; empty where nothing is judged there."""
    met, of = runs.passed(run, name, mode)
    if mode in SHOWN_LEVELS or not of:
        return ""
    every = len(runs.judged(run))
    text = f"{'✓' if met == every else '✗'} {runs.mode_words(mode)} {met} of {every}"
    return text.replace(" ", "\u00a0")
