"""Sections of a fit to signals over time: the answer, the engines, what the data can tell."""

from __future__ import annotations

from dataclasses import replace

from simcompare.reports.fit import fits, more_figures, short, waveforms
from simcompare.reports.fit import tables as fitted_tables
from simcompare.reports.render.parts import Part, part_of
from simcompare.results.run import Run


def answer(run: Run) -> Part:
    """What was found, and the recording with the engines over it."""
    record = fits.signals(run)
    part = part_of(
        "Answer", "answer", waveforms.measured_figures(run),
        [waveforms.parameters(run), fitted_tables.failed(run)],
        answer=short.others(run, (*record.chosen_words, *record.sentences)),
    )  # fmt: skip
    return replace(part, short=short.short(run), key_numbers=short.key_numbers(run))


def residuals(run: Run) -> Part:
    """What is left of the measured signals, segment by segment."""
    return part_of("What is left", "residuals", waveforms.residual_figures(run))


def engines(run: Run) -> Part:
    """What each engine must be given, and the effective values that it then shows."""
    tables = [fitted_tables.parameters(run), waveforms.effective(run)]
    return part_of("Each engine", "engines", tables=tables, finding="")


def holdout(run: Run) -> Part | None:
    """Whether the fit predicts segments that it has not seen; ``None`` where there are none."""
    if not fits.signals(run).holdout.streams:
        return None
    return part_of(
        "Segments that were not fitted",
        "holdout",
        tables=[waveforms.holdout(run)],
        notes=[fits.signals(run).holdout.text],
    )


def identifiability(run: Run) -> Part:
    """What the data can tell and what they cannot: correlations and singular values."""
    facts = "; ".join(f"{name}: {words}" for name, words in waveforms.valid(run).items())
    return part_of(
        "What the data can tell",
        "identifiability",
        [more_figures.correlation_figure(run)],
        [fitted_tables.directions(run)],
        [
            *fits.signals(run).identifiability.words,
            f"the fit holds for what it was made with: {facts}",
        ],
        finding=fits.determined_words(run),
    )
