"""What a section of a report is, and a block of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, NamedTuple

from simcompare.reports.render.figures import Figure
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


class Filled(NamedTuple):
    """A section with what it shows of one run."""

    section: Section
    context: dict[str, Any]


class Block(NamedTuple):
    """One run in a report.

    Attributes:
        anchor: prefix of everything that is linked to in this block.
        name: what the names of its files start with.
        record: the run's record.
        sections: what there is to show, in order.
    """

    anchor: str
    name: str
    record: Any
    sections: list[Filled]

    @property
    def figures(self) -> list[Figure]:
        """Every figure of the run."""
        return [figure for filled in self.sections for figure in filled.context.get("figures", ())]

    @property
    def contexts(self) -> dict[str, dict[str, Any]]:
        """Contexts of the sections by their names."""
        return {filled.section.name: filled.context for filled in self.sections}
