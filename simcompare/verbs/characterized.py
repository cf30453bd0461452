"""What ``characterize`` gives to Python: a characterization that shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from simcompare.errors import UnknownName
from simcompare.reports.characterization import page, tables
from simcompare.reports.render import frames
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown, plotted
from simcompare.results.records.characterization import Characterization

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, repr=False)
class Characterized(Shown, Characterization):
    """What the experiments found.

    A notebook shows the first experiment. Besides::

        found = simcompare.characterize("bounce,friction", engine="mujoco,ode")
        found.table("friction")
        found.plot()
    """

    def table(self, experiment: str | None = None) -> pd.DataFrame:
        """What engines did in an experiment; in the first one where ``None``.

        Raises:
            UnknownName: it was not done; names those that were.
        """
        name = self.experiments[0] if experiment is None else experiment
        if name not in self.experiments:
            raise UnknownName("experiment that was done", name, self.experiments)
        return frames.frame(tables.of(self, name))

    def plot(self, name: str | None = None) -> Figure:
        """A figure of the page by its name; the first where ``None``.

        Raises:
            UnknownName: there is none of that name; names those that there are.
        """
        return plotted(page.block_of(self).figures, name)

    def _glance(self) -> Glance:
        answer = page.block_of(self).parts[0]
        place = "" if self.folder is None else f". Stored in {self.folder}"
        return Glance(
            title=self.title,
            question=self.question,
            sentences=answer.short or answer.answer,
            table=tables.of(self, self.experiments[0]),
            figure=next(iter(answer.figures), None),
            more=f"More: .table(experiment), .plot(name){place}",
        )
