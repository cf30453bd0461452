"""Sections of a fit: the answer, the engines, the closed forms, and what the data can tell."""

from __future__ import annotations

from dataclasses import replace

from simcompare.reports.fit import (
    budget,
    engine_words,
    fits,
    measured_figures,
    measured_tables,
    more_figures,
    short,
    summary_tables,
    tuned,
)
from simcompare.reports.fit import figures as fitted_figures
from simcompare.reports.fit import tables as fitted_tables
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Part, part_of
from simcompare.results.run import Run

_TWO_THINGS = (
    "The parameter is what an engine must be given; the effective restitution is what it then"
    " shows. Compare engines by the second. The first holds for this engine and this step alone."
)


def answer(run: Run) -> Part:
    """What was found, what was measured with the engines over it, and the table of engines."""
    first, *others = measured_figures.measured_figures(run)
    drops = tuple(figure for figure in others if figure is not None)
    table = tuned.typed if fits.bounces(run).is_tuned else fitted_tables.engines
    under_table = engine_words.one_number(fits.bounces(run))
    part = part_of(
        "Answer", "answer", [first, measured_figures.simulated_figure(run)],
        [table(run), summary_tables.found(run), measured_tables.left_out(run),
         fitted_tables.failed(run)],
        answer=[text for text in short.others(run, fits.bounces(run).sentences)
                if text not in under_table],
    )  # fmt: skip
    folded = Part("The other drops", figures=drops, folded=True)
    return replace(part, short=short.short(run), key_numbers=short.key_numbers(run),
                   parts=(folded,) if drops else ())  # fmt: skip


def residuals(run: Run) -> Part:
    """Measured less simulated, for every kind of number that was measured."""
    figures: list[Figure | None] = [*fitted_figures.residual_figures(run)]
    if fits.bounces(run).is_tuned:
        figures.append(tuned.impacts_figure(run))
    return part_of("What is left", "residuals", figures)


def engines(run: Run) -> Part:
    """Parameters beside effective values, or impact by impact, and native contact values."""
    native = fitted_tables.native(run)
    if fits.bounces(run).is_tuned:
        return part_of(
            "Each engine",
            "engines",
            tables=[tuned.contacts(run), tuned.impacts(run), native],
            finding="",
        )
    figures = [fitted_figures.parameter_figure(run)]
    tables = [fitted_tables.parameters(run), native]
    return part_of("Each engine", "engines", figures, tables, [_TWO_THINGS])


def forms(run: Run) -> Part:
    """Criteria of every closed form that might describe the data."""
    tables = [fitted_tables.forms(run), fitted_tables.refused(run)]
    notes = fits.bounces(run).choice.words
    figures = [more_figures.forms_figure(run)]
    return part_of("Which closed form", "forms", figures, tables, notes,
                   finding=fits.bounces(run).closed_form.text)  # fmt: skip


def speed(run: Run) -> Part:
    """Restitution against speed: every bounce of every source."""
    return part_of("Bounce by bounce", "speed", [fitted_figures.speed_figure(run)], finding="")


def identifiability(run: Run) -> Part:
    """What the data can tell and what they cannot: correlations, singular values, profiles."""
    figures = [more_figures.correlation_figure(run), *more_figures.profile_figures(run)]
    tables = [budget.table(run), fitted_tables.bootstrap(run), fitted_tables.directions(run)]
    notes = fits.bounces(run).identifiability.words
    return part_of(
        "What the data can tell",
        "identifiability",
        figures,
        tables,
        notes,
        finding=fits.determined_words(run),
    )


def holdout(run: Run) -> Part | None:
    """Whether the fit predicts drops that it has not seen; ``None`` where there are none."""
    if not fits.bounces(run).holdout.drops:
        return None
    tables = [fitted_tables.holdout(run), tuned.heights(run)]
    notes = [fits.bounces(run).holdout.text]
    figures = [more_figures.holdout_figure(run)]
    return part_of("Drops that were not fitted", "holdout", figures, tables, notes)


def others(run: Run) -> Part | None:
    """What one would have concluded by other rules; ``None`` where there are none."""
    table = fitted_tables.others(run)
    if table is None:
        return None
    return part_of(
        "What other rules would give",
        "others",
        [more_figures.others_figure(run)],
        [table],
        finding="",
    )


def measured(run: Run) -> Part:
    """What was measured, left out, fixed and known before, and where the fit holds."""
    tables = [measured_tables.measured(run), measured_tables.known(run)]
    drops = (*fits.bounces(run).measured, *fits.bounces(run).held_out)
    notes = [f"{drop.source}: {note}" for drop in drops for note in drop.notes]
    facts = measured_tables.valid(run)
    return part_of(
        "The recording and the range",
        "measured",
        tables=tables,
        notes=notes,
        facts=facts,
        finding="",
    )
