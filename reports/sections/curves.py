"""Series over an axis of their own, such as a response over frequency."""

from __future__ import annotations

from typing import Any

from simcompare.reports.run import curve_figures
from simcompare.reports.sections.base import Section
from simcompare.results.run import Run


class Curves(Section):
    """Curves, and how far they are from the truth."""

    name, title, template = "curves", "Curves", "figures.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Figures for each axis; ``None`` where nothing was measured over one.

        The figure that leads the report is not drawn a second time.
        """
        axes = curve_figures.axes_drawn(run)
        leading = curve_figures.leading_axis(run)
        figures = [
            figure
            for axis in axes
            for figure in curve_figures.curves_figures(run, axis)[1 if axis == leading else 0 :]
        ]
        figures += [
            figure for axis in axes for figure in curve_figures.deviations_figures(run, axis)
        ]
        return {"figures": figures} if figures else None
