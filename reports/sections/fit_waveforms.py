"""Sections of a fit to signals over time: the answer, the engines, what the data can tell."""

from __future__ import annotations

from typing import Any

from simcompare.reports.fit import fits, more_figures, waveforms
from simcompare.reports.fit import tables as fitted_tables
from simcompare.reports.render.tables import printable
from simcompare.reports.sections.base import Section
from simcompare.reports.sections.parts import parts_of
from simcompare.results.run import Run


class WavesAnswer(Section):
    """What was found, in words, and what is left of the measured signals."""

    name, title, template = "answer", "Answer", "real_answer.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Sentences of the record and residuals."""
        found = fits.record(run)
        said = [printable(text) for text in (*found["told"], *found["sentences"])]
        return {
            "question": run.record.question,
            "answer": said,
            **parts_of(waveforms.residual_figures(run), []),
        }


class WavesEngines(Section):
    """What each engine must be given, and what it then shows."""

    name, title, template = "engines", "Each engine", "real_part.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Parameters, and effective values."""
        tables = [fitted_tables.failed(run), fitted_tables.parameters(run)._replace(folded=False),
                  waveforms.effective(run)]  # fmt: skip
        return parts_of([], tables)


class WavesHeldOut(Section):
    """Whether the fit predicts stretches that it has not seen."""

    name, title, template = "holdout", "Stretches that were not fitted", "real_part.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Held-out values, or that there are none."""
        return parts_of([], [waveforms.holdout(run)], fits.record(run)["holdout"]["text"])


class WavesKnown(Section):
    """What the data can tell and what they cannot."""

    name, title, template = "identifiability", "What the data can tell", "real_part.html"

    def context(self, run: Run) -> dict[str, Any]:
        """Correlations and singular values."""
        facts = "; ".join(f"{name}: {words}" for name, words in waveforms.valid(run).items())
        return parts_of([more_figures.correlation_figure(run)], [fitted_tables.directions(run)],
                      *fits.record(run)["identifiability"]["words"],
                      f"the fit holds for what it was made with: {facts}")  # fmt: skip
