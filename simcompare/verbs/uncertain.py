"""What ``uncertainty`` gives to Python: a result that shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from simcompare import glossary
from simcompare.errors import UnknownName
from simcompare.reports.render import frames, matplotlib_
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.uncertainty import answer, tables
from simcompare.reports.uncertainty.figures import figure_of
from simcompare.results.records.uncertainty import Uncertainty

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, repr=False)
class Uncertain(Shown, Uncertainty):
    """How well a result is known.

    A notebook shows the answer, the budget and the picture. Besides::

        found = simcompare.uncertainty("robot", of="acceleration", engine="mujoco")
        found.table("mujoco")
        found.plot("mujoco")
        found.ways[0].found.budget.expanded
    """

    def table(self, source: str | None = None) -> pd.DataFrame:
        """The budget of one way to the result; of the first one where ``None``.

        Raises:
            UnknownName: it gave no result; names those that did.
        """
        return frames.frame(tables.budget_of(self, self._number(source)))

    def plot(self, source: str | None = None) -> Figure:
        """Shares and distribution of one way to the result; of the first one where ``None``.

        Raises:
            UnknownName: it gave no result, or nothing is uncertain.
        """
        figure = figure_of(self, self._number(source))
        if figure is None:
            raise UnknownName("figure", source or "", ())
        return matplotlib_.canvas(figure)

    def _number(self, source: str | None) -> int:
        names = [way.source for way, _ in self.known]
        wanted = next(iter(names), "") if source is None else source
        if wanted not in names:
            raise UnknownName("way to the result", wanted, names)
        return names.index(wanted)

    def _glance(self) -> Glance:
        place = "" if self.folder is None else f". Stored in {self.folder}"
        return Glance(
            title=self.title,
            question=self.question,
            sentences=tuple(answer.sentences(self)),
            legend=glossary.legend(tables.BUDGET_WORDS),
            table=tables.budget_of(self) if self.known else None,
            notes=tuple(answer.notes(self)),
            figure=figure_of(self),
            more=f"More: .table(source), .plot(source){place}",
        )
