"""Sections of a validation: the answer, the gap, the values, the parameters, the recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Part, Section, part_of
from simcompare.reports.run.not_run import not_run
from simcompare.reports.sections import pictures
from simcompare.reports.validation import (
    events,
    gap_figures,
    parameter_tables,
    phrases,
    short,
    summary_table,
    validations,
    waveforms,
)
from simcompare.reports.validation import source as recorded
from simcompare.reports.validation import tables as real_tables
from simcompare.results.run import Run

#: figures of the recording that are seen at once, the others on request
_OPEN = 2


def answer(run: Run) -> Part:
    """The recording with the engines over it, and how far they are off."""
    validation = validations.validation(run)
    figures = [
        figure
        for probe in validations.judged_probes(run)
        for figure in waveforms.overlay_figures(run, probe)
    ]
    said = short.short(validation)
    sentences = [sentence for sentence in validation.sentences if sentence not in said]
    if missing := sorted({row.name for row in not_run(run)}):
        sentences.append(f"Did not run: {', '.join(missing)}.")
    tables = [summary_table.summary(validation)]
    figures = figures or [figure for figure in [events.figure(run)] if figure is not None]
    part = part_of("Answer", "answer", figures[:_OPEN], tables, answer=sentences)
    return replace(part, short=said, key_numbers=short.key_numbers(validation),
                   parts=_others(figures[_OPEN:]))  # fmt: skip


def _others(figures: Sequence[Figure]) -> tuple[Part, ...]:
    words = "The other quantities and segments"
    return (Part(words, figures=tuple(figures), folded=True),) if figures else ()


def gap(run: Run) -> Part | None:
    """What the gap is made of; ``None`` where no gap could be split."""
    figures = gap_figures.gap_figures(run)
    if not figures:
        return None
    title = "What the gap is made of"
    return part_of(title, "gap", figures, real_tables.gaps(run), finding="")


def residuals(run: Run) -> Part | None:
    """What is left over time: a figure for each judged probe."""
    figures = [waveforms.residual_figure(run, p) for p in validations.judged_probes(run)]
    table = real_tables.waveforms(run)._replace(title="Every segment", folded=True)
    return part_of("What is left", "residuals", figures, [table]) if any(figures) else None


def timings(run: Run) -> Part | None:
    """When things happened; ``None`` where no events are compared."""
    tables = [events.summary(run), events.intervals(run)]
    figures = [events.figure(run)] if validations.validation(run).waveforms else []
    return part_of("Events", "timings", figures, tables) if any(tables) else None


def values(run: Run) -> Part | None:
    """Single values with their uncertainty; ``None`` where nothing was measured on both."""
    if not validations.validation(run).values:
        return None
    tables = [real_tables.values(run), real_tables.agreement(run)]
    return part_of("Single values", "values", [gap_figures.e_n_figure(run)], tables)


def parameters(run: Run) -> Part:
    """What was known, what was fitted, where each number comes from, and single segments."""
    fitted = [row for row in validations.validation(run).parameters if row.fitted is not None]
    return part_of(
        "Parameters",
        "parameters",
        [gap_figures.parameter_figure(run)],
        [parameter_tables.parameters(run), parameter_tables.single_fits(run)],
        [validations.validation(run).note, _fit_words(run), _bound(run)],
        finding=f"{len(fitted)} fitted" if fitted else "known before",
    )


def _fit_words(run: Run) -> str:
    fit = validations.validation(run).fit
    if fit is None:
        return "Nothing was fitted."
    streams = ", ".join(validations.short(name) for name in fit.streams if name != validations.ONLY)
    where = f"{fit.recording}, {streams}" if streams else fit.recording
    return f"Fitted to {where}. Uncertainty of the fit from: {fit.how}."


def _bound(run: Run) -> str:
    fit = validations.validation(run).fit
    names = [] if fit is None else [phrases.parameter(name) for name in fit.at_bound]
    return f"At its limit: {phrases.listed(names)}." if names else ""


def recording(run: Run) -> Part:
    """The recording: where it comes from, and all that was done to it."""
    repairs = recorded.repairs(run)
    is_sound = all(table.folded for table in repairs)
    tables = [*repairs, recorded.segments(run), recorded.events(run), recorded.conversions(run)]
    notes = ["No defect was found in the log: nothing was repaired."] if is_sound else []
    facts = recorded.facts(run)
    return part_of(
        "The recording", "recording", tables=tables, notes=notes, facts=facts,
        finding="no defect" if is_sound else "the log had defects",
    )  # fmt: skip


#: in the order in which a reader wants them
SECTIONS: tuple[Section, ...] = (
    answer,
    pictures.moving,
    residuals,
    timings,
    values,
    gap,
    parameters,
    recording,
)
