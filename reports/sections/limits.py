"""Known limits of the engines, with references."""

from __future__ import annotations

from typing import Any

from simcompare.reports.sections.base import Section
from simcompare.results.run import Run


class Limits(Section):
    """What a user of an engine will meet."""

    name, title, template = "limits", "Known limits", "limits.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """The limits of each engine once; ``None`` where none is known."""
        engines = {source.name: source.known_limits for source in run.record.sources}
        found = {name: limits for name, limits in engines.items() if limits}
        return {"engines": found} if found else None
