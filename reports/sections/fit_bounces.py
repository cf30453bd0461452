"""Sections of a fit: the answer, the engines, the closed forms, and what the data can tell."""

from __future__ import annotations

from simcompare.reports.fit import figures as fitted_figures
from simcompare.reports.fit import fits, measured_tables, more_figures, tuned
from simcompare.reports.fit import tables as fitted_tables
from simcompare.reports.render.parts import Part, part_of
from simcompare.results.run import Run

_TWO_THINGS = (
    "The parameter is what an engine must be given; the effective restitution is what its motion"
    " then shows. Only the second compares engines. The first is the number to type in, and holds"
    " for this engine and this step alone."
)
_ALONE = (
    "The numbers were solved on drops in the engine itself, at the speed of the first impact and at"
    " this step, and then held fixed. They hold for this engine and this step alone."
)


def answer(run: Run) -> Part:
    """What was found, in words, what is left of the measured events, and the table of engines."""
    missing = sorted({row.name for row in fits.failed(run)})
    sentences = list(fits.bounces(run).sentences)
    if missing:
        sentences.append(f"Could not be fitted: {', '.join(missing)}; the reasons are below.")
    table = tuned.typed if fits.bounces(run).is_tuned else fitted_tables.engines
    return part_of(
        "Answer", "answer", fitted_figures.residual_figures(run), [table(run)], answer=sentences
    )


def engines(run: Run) -> Part:
    """Parameters beside effective values, or impact by impact, and native contact values."""
    failed, native = fitted_tables.failed(run), fitted_tables.native(run)
    if fits.bounces(run).is_tuned:
        figures, tables = [tuned.impacts_figure(run)], [failed, tuned.impacts(run), native]
        return part_of("Each engine", "engines", figures, tables, [_ALONE])
    figures = [fitted_figures.parameter_figure(run)]
    tables = [failed, fitted_tables.parameters(run), native]
    other = fits.other_form(run)
    note = f"{other} So is the closed form in this section." if other else ""
    return part_of("Each engine", "engines", figures, tables, [_TWO_THINGS, note])


def forms(run: Run) -> Part:
    """Criteria of every closed form that might describe the data."""
    tables = [fitted_tables.forms(run), fitted_tables.refused(run)]
    notes = fits.bounces(run).choice.words
    figures = [more_figures.forms_figure(run)]
    return part_of("Which closed form", "forms", figures, tables, notes)


def speed(run: Run) -> Part:
    """Restitution against speed: every bounce of every source."""
    return part_of("Bounce by bounce", "speed", [fitted_figures.speed_figure(run)])


def identifiability(run: Run) -> Part:
    """What the data can tell and what they cannot: correlations, singular values, profiles."""
    figures = [more_figures.correlation_figure(run), *more_figures.profile_figures(run)]
    tables = [fitted_tables.bootstrap(run), fitted_tables.directions(run)]
    notes = fits.bounces(run).identifiability.words
    return part_of("What the data can tell", "identifiability", figures, tables, notes)


def holdout(run: Run) -> Part:
    """Whether the fit predicts drops that it has not seen, or that there are none."""
    tables = [fitted_tables.holdout(run), tuned.heights(run)]
    notes = [fits.bounces(run).holdout.text]
    figures = [more_figures.holdout_figure(run)]
    return part_of("Drops that were not fitted", "holdout", figures, tables, notes)


def others(run: Run) -> Part | None:
    """What one would have concluded with another residual; ``None`` where there are none."""
    table = fitted_tables.others(run)
    if table is None:
        return None
    return part_of("With another residual", "others", [more_figures.others_figure(run)], [table])


def measured(run: Run) -> Part:
    """What was measured, left out, fixed and known before, and where the fit holds."""
    tables = [
        measured_tables.measured(run),
        measured_tables.left_out(run),
        measured_tables.known(run),
    ]
    drops = (*fits.bounces(run).measured, *fits.bounces(run).held_out)
    notes = [f"{drop.source}: {note}" for drop in drops for note in drop.notes]
    facts = measured_tables.valid(run)
    return part_of("What was measured", "measured", tables=tables, notes=notes, facts=facts)
