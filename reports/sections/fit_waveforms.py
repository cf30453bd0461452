"""Sections of a fit to signals over time: the answer, the engines, what the data can tell."""

from __future__ import annotations

from simcompare.reports.fit import fits, more_figures, waveforms
from simcompare.reports.fit import tables as fitted_tables
from simcompare.reports.render.parts import Part, part_of
from simcompare.results.run import Run


def answer(run: Run) -> Part:
    """What was found, in words, and what is left of the measured signals."""
    record = fits.signals(run)
    sentences = (*record.chosen_words, *record.sentences)
    return part_of("Answer", "answer", waveforms.residual_figures(run), answer=sentences)


def engines(run: Run) -> Part:
    """What each engine must be given, and the effective values that it then shows."""
    parameters = fitted_tables.parameters(run)._replace(folded=False)
    tables = [fitted_tables.failed(run), parameters, waveforms.effective(run)]
    return part_of("Each engine", "engines", tables=tables)


def holdout(run: Run) -> Part:
    """Whether the fit predicts segments that it has not seen, or that there are none."""
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
    )
