"""The probes beside the leading one."""

from __future__ import annotations

from typing import Any

from simcompare.reports import runs, timelines
from simcompare.reports.sections.base import Section
from simcompare.results import Run

#: so many are seen at once, the others on request
_OPEN = 2


class Signals(Section):
    """Everything else that is observed, over time."""

    name, title, template = "signals", "Other signals", "signals.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """One figure for each further probe; ``None`` where there is none."""
        further = list(runs.probes(run).items())[1:]
        if not further:
            return None
        figures = [timelines.probe_figure(run, name, probe) for name, probe in further]
        return {"figures": figures, "open": _OPEN}
