"""Sections of a fit by tosses: the answer, and what the tosses can tell."""

from __future__ import annotations

from dataclasses import replace

from simcompare.reports.fit import short, tosses
from simcompare.reports.render.parts import Part, part_of
from simcompare.results.run import Run


def answer(run: Run) -> Part:
    """What was found, errors of every toss that was predicted, and the table of engines."""
    found = tosses.found_of(run)
    tables = [tosses.engines(found), tosses.failed(found)]
    sentences = short.others(run, (*found.told, *found.sentences))
    figures = [tosses.measured_figure(run), tosses.holdout_figure(found)]
    part = part_of("Answer", "answer", figures, tables, answer=sentences)
    return replace(part, short=short.short(run), key_numbers=short.key_numbers(run))


def identifiability(run: Run) -> Part:
    """What the tosses can tell: what was tried, and what they say of their own scale."""
    found = tosses.found_of(run)
    low, high = found.valid.speed_m_s
    note = (
        f"The fit holds for what it was made with: first touches at {low:.2g} to {high:.2g} m/s"
        f" and a step of {1e3 * found.valid.engine_step_s:.4g} ms"
    )
    return part_of(
        "What the data can tell",
        "identifiability",
        [tosses.cost_figure(found)],
        [tosses.scales(found)],
        [note],
        finding="",
    )
