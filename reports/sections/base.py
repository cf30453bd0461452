"""What a section of a report is."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from simcompare.results.run import Run


class Section(ABC):
    """One part of a report: a template and what it is filled with.

    Attributes:
        name: short name, for anchors.
        title: its heading, also in the table of contents.
        template: file in ``templates/``.
    """

    name: str
    title: str
    template: str

    @abstractmethod
    def context(self, run: Run) -> dict[str, Any] | None:
        """What the template shows of a run, ``None`` where there is nothing to show.

        Figures stand under ``"figures"``, so that they can be drawn on their own.
        """
