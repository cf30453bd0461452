"""Everything that is observed, over time."""

from __future__ import annotations

from typing import Any

from simcompare.reports.run import curve_figures, motion_figures, runs
from simcompare.reports.sections.base import Section
from simcompare.results.run import Run

#: so many are seen at once, the others on request
_OPEN = 2


class Signals(Section):
    """Every probe at every level, over time."""

    name, title, template = "signals", "Over time", "signals.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """One figure for each probe; ``None`` where there is none."""
        probes = list(runs.probes(run).items())
        if len(runs.modes(run)) == 1 and not curve_figures.leading_axis(run):
            probes = probes[1:]  # the whole of the first is in the answer
        if not probes:
            return None
        figures = [motion_figures.probe_figure(run, name, probe) for name, probe in probes]
        return {"figures": figures, "open": _OPEN}
