"""Default beside assisted."""

from __future__ import annotations

from typing import Any

from simcompare.reports.run import score_figures
from simcompare.reports.sections.base import Section
from simcompare.results.run import Run


class Contrast(Section):
    """All judged scores of all engines in one picture."""

    name, title, template = "contrast", "Deviation in tolerances", "figures.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """The figure; ``None`` where nothing has a truth and a tolerance."""
        figure = score_figures.contrast_figure(run)
        return None if figure is None else {"figures": [figure]}
