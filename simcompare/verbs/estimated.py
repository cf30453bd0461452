"""What ``estimate`` gives to Python: an estimation that shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from simcompare.reports.estimation import chips, figures, page, tables
from simcompare.reports.render import frames
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown, plotted
from simcompare.results.records.estimation import Estimation

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, repr=False)
class Estimated(Shown, Estimation):
    """What sensors told of a motion.

    A notebook shows the state that leads. Besides::

        found = simcompare.estimate("robot_motor", engine="mujoco")
        found.table()
        found.plot("nees")
    """

    def table(self) -> pd.DataFrame:
        """How far each way is off, a row a source; of a study of chips, a row a chip."""
        return frames.frame(chips.table(self) or tables.lead(self))

    def plot(self, name: str | None = None) -> Figure:
        """A figure of the page by its name; the first where ``None``.

        Raises:
            UnknownName: there is none of that name; names those that there are.
        """
        return plotted(figures.figures(self), name)

    def _glance(self) -> Glance:
        place = "" if self.folder is None else f". Stored in {self.folder}"
        return Glance(
            title=self.title,
            question=self.question,
            sentences=self.sentences,
            legend=page.legend(self) if self.done else (),
            table=chips.table(self) or tables.lead(self) if self.done else None,
            figure=next(iter(figures.figures(self)), None),
            more=f"More: .table(), .plot(name){place}",
        )
