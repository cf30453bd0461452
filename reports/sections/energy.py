"""Mechanical energy over time."""

from __future__ import annotations

from typing import Any

from simcompare.reports.run import motion_figures
from simcompare.reports.sections.base import Section
from simcompare.results.run import Run


class Energy(Section):
    """Where the energy goes."""

    name, title, template = "energy", "Energy", "figures.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """The figure; ``None`` where the scenario does not tell what it takes."""
        figure = motion_figures.energy_figure(run)
        return None if figure is None else {"figures": [figure]}
