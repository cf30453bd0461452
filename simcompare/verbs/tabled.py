"""What ``validate`` gives to Python for a table of results: a result that shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from simcompare import glossary
from simcompare.errors import UnknownName
from simcompare.reports.render import frames, matplotlib_
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.tabled import tables, words
from simcompare.reports.tabled.figures import figures_of
from simcompare.results.records.tabled import TableValidation

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, repr=False)
class Tabled(Shown, TableValidation):
    """A table of results against simulations.

    A notebook shows the answer, the verdicts and the picture. Besides::

        found = simcompare.validate("pendulum", recording="periods.csv", engine="mujoco")
        found.table("mean_period")  # every row
        found.plot()
        found.results[0].told
    """

    def table(self, result: str | None = None) -> pd.DataFrame:
        """Verdicts of all sources; every row of a result where one is named.

        Raises:
            UnknownName: the table holds no such result; names those that it holds.
        """
        if result is None:
            return frames.frame(tables.verdicts(self))
        return frames.frame(tables.rows(self.results[self._number(result)]))

    def plot(self, result: str | None = None) -> Figure:
        """The picture of a result; of the first one where ``None``.

        Raises:
            UnknownName: the table holds no such result; names those that it holds.
        """
        number = 0 if result is None else self._number(result)
        return matplotlib_.canvas(figures_of(self)[number])

    def _number(self, result: str) -> int:
        names = [one.name for one in self.results]
        if result not in names:
            raise UnknownName("result of the table", result, names)
        return names.index(result)

    def _glance(self) -> Glance:
        place = "" if self.folder is None else f". Stored in {self.folder}"
        return Glance(
            title=self.title,
            question=self.question,
            sentences=tuple(words.sentences(self)),
            legend=glossary.legend(words.WORDS),
            table=tables.verdicts(self),
            notes=tuple(words.not_run(self)),
            figure=figures_of(self)[0],
            more=f"More: .table(result), .plot(result){place}",
        )
