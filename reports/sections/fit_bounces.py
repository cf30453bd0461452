"""Sections of a fit: the answer, the engines, the closed forms, and what the data can tell."""

from __future__ import annotations

from typing import Any

from simcompare.reports.fit import figures as fitted_figures
from simcompare.reports.fit import fits, more_figures, tuned
from simcompare.reports.fit import tables as fitted_tables
from simcompare.reports.render.tables import printable
from simcompare.reports.sections.base import Section
from simcompare.reports.sections.parts import parts_of
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


class FitAnswer(Section):
    """What was found, in words, and what is left of the measured events."""

    name, title, template = "answer", "Answer", "real_answer.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Sentences of the record, residuals and the table of engines."""
        missing = sorted({row["name"] for row in fits.failed(run)})
        said = [printable(text) for text in fits.record(run)["sentences"]]
        if missing:
            said.append(f"Could not be fitted: {', '.join(missing)}; the reasons are below.")
        table = tuned.typed if tuned.is_tuned(run) else fitted_tables.engines
        return {
            "question": run.record.question,
            "answer": said,
            **parts_of(fitted_figures.left_figures(run), [table(run)]),
        }


class FitEngines(Section):
    """What each engine must be given, and what it then shows."""

    name, title, template = "engines", "Each engine", "real_part.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Parameters beside effective values, or impact by impact, and native contact values."""
        if tuned.is_tuned(run):
            tables = [fitted_tables.failed(run), tuned.impacts(run),
                      fitted_tables.native(run)]  # fmt: skip
            return parts_of([tuned.impacts_figure(run)], tables, _ALONE)
        tables = [fitted_tables.failed(run), fitted_tables.parameters(run),
                  fitted_tables.native(run)]  # fmt: skip
        other = fits.other_form(run)
        note = f"{other} So is the closed form in this section." if other else ""
        return parts_of([fitted_figures.parameter_figure(run)], tables, _TWO_THINGS, note)


class FitForms(Section):
    """Which closed form describes the data."""

    name, title, template = "forms", "Which closed form", "real_part.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Criteria of every candidate."""
        tables = [fitted_tables.forms(run), fitted_tables.refused(run)]
        return parts_of([more_figures.forms_figure(run)], tables,
                      *fits.record(run)["choice"]["words"])  # fmt: skip


class FitSpeed(Section):
    """Restitution against speed."""

    name, title, template = "speed", "Bounce by bounce", "real_part.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Every bounce of every source."""
        return parts_of([fitted_figures.speed_figure(run)], [])


class FitKnown(Section):
    """What the data can tell and what they cannot."""

    name, title, template = "identifiability", "What the data can tell", "real_part.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Correlations, singular values, profiles."""
        figures = [more_figures.correlation_figure(run), *more_figures.profile_figures(run)]
        tables = [fitted_tables.bootstrap(run), fitted_tables.directions(run)]
        return parts_of(figures, tables, *fits.record(run)["identifiability"]["words"])


class FitHeldOut(Section):
    """Whether the fit predicts drops that it has not seen."""

    name, title, template = "holdout", "Drops that were not fitted", "real_part.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Held-out drops, or that there are none."""
        tables = [fitted_tables.holdout(run), tuned.heights(run)]
        return parts_of([more_figures.holdout_figure(run)], tables,
                        fits.record(run)["holdout"]["text"])  # fmt: skip


class FitOthers(Section):
    """What one would have concluded with another residual."""

    name, title, template = "others", "With another residual", "real_part.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Other estimates; ``None`` where there are none."""
        table = fitted_tables.others(run)
        return None if table is None else parts_of([more_figures.others_figure(run)], [table])


class FitMeasured(Section):
    """What was measured, left out, fixed and known before, and where the fit holds."""

    name, title, template = "measured", "What was measured", "real_recording.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Drops and the range of validity."""
        tables = [fitted_tables.measured(run), fitted_tables.left_out(run),
                  fitted_tables.known(run)]  # fmt: skip
        drops = (*fits.record(run)["measured"], *fits.record(run)["held_out"])
        notes = [f"{drop['source']}: {note}" for drop in drops for note in drop["notes"]]
        return {"facts": fitted_tables.valid(run), **parts_of([], tables, *notes)}
