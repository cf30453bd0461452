"""Sections of a validation: the answer, the gap, the values, the parameters, the recording."""

from __future__ import annotations

from typing import Any

from simcompare.reports.render.figures import Figure
from simcompare.reports.render.tables import Table, printable
from simcompare.reports.run import runs
from simcompare.reports.sections.base import Section
from simcompare.reports.validation import (
    events,
    gap_figures,
    phrases,
    source,
    validations,
    waveforms,
)
from simcompare.reports.validation import tables as real_tables
from simcompare.results.run import Run


class RealAnswer(Section):
    """What was found, in words, and measured and simulated over each other."""

    name, title, template = "answer", "Answer", "real_answer.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Sentences and the overlay of every judged probe."""
        found = validations.validation(run)
        figures = [
            figure
            for probe in validations.judged_probes(run)
            for figure in waveforms.overlay_figures(run, probe)
        ]
        return {
            "question": run.record.question,
            "answer": [*map(printable, found.sentences), *_not_run(run)],
            **_parts(figures, [real_tables.waveforms(run)] if found.waveforms else []),
        }


def _not_run(run: Run) -> list[str]:
    missing = sorted({row["name"] for row in runs.not_run(run)})
    return [f"Did not run: {', '.join(missing)}; the reasons are below."] if missing else []


def _parts(
    figures: list[Figure] | list[Figure | None],
    tables: list[Table] | list[Table | None],
    *notes: str,
) -> dict[str, Any]:
    """Figures, tables and remarks, as far as there are any."""
    return {
        "figures": [figure for figure in figures if figure is not None],
        "grids": [table for table in tables if table is not None],
        "notes": [printable(note) for note in notes if note],
    }


class Gap(Section):
    """What the gap is made of."""

    name, title, template = "gap", "What the gap is made of", "real_part.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Figure and tables; ``None`` where no gap could be split."""
        figures = gap_figures.gap_figures(run)
        return _parts(figures, [*real_tables.gaps(run)]) if figures else None


class Residuals(Section):
    """What is left over time."""

    name, title, template = "residuals", "What is left", "real_part.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """A figure for each judged probe."""
        found = _parts(
            [waveforms.residual_figure(run, p) for p in validations.judged_probes(run)], []
        )
        return found if found["figures"] else None


class Timings(Section):
    """When things happened."""

    name, title, template = "timings", "Events", "real_part.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Figure and tables of events; ``None`` where none are compared."""
        tables = [events.summary(run), events.intervals(run)]
        found = _parts([events.figure(run)], tables)
        return found if found["grids"] else None


class RealValues(Section):
    """Single values with their uncertainty."""

    name, title, template = "values", "Single values", "real_part.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Figure of E_n and tables; ``None`` where nothing was measured on both."""
        if not validations.validation(run).values:
            return None
        tables = [real_tables.values(run), real_tables.agreement(run)]
        return _parts([gap_figures.e_n_figure(run)], tables)


class Parameters(Section):
    """What was known, what was fitted, and where each number comes from."""

    name, title, template = "parameters", "Parameters", "real_part.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Figure and tables of all parameters, and what single stretches gave."""
        tables = [real_tables.parameters(run), real_tables.single_fits(run)]
        note = validations.validation(run).note
        return _parts(
            [gap_figures.parameter_figure(run)], tables, note, _fit_words(run), _bound(run)
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
    return f"At a bound: {', '.join(names)}; the fit wanted to go further." if names else ""


class Source(Section):
    """The recording: where it comes from and all that was done to it."""

    name, title, template = "recording", "The recording", "real_recording.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Provenance, repairs, stretches and conversions."""
        repairs = source.repairs(run)
        unharmed = not any(not table.folded for table in repairs)
        tables = [*repairs, source.segments(run), source.events(run),
                  source.conversions(run)]  # fmt: skip
        note = "No defect was found in the log: nothing was repaired." if unharmed else ""
        return {"facts": source.facts(run), **_parts([], tables, note)}
