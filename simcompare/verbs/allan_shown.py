"""What ``allan`` gives to Python: an analysis of noise that shows itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from simcompare.reports.allan import figures, tables, words
from simcompare.reports.render import frames, matplotlib_
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.render.tables import Table
from simcompare.results.records.allan import NoiseAnalysis

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, repr=False)
class Allan(Shown, NoiseAnalysis):
    """The noise of a sensor at rest.

    ::

        found = simcompare.allan("imu_xio")
        found.table()         # each noise with its uncertainty
        found.deviations()    # every Allan deviation with its bounds
        found.plot()
        found.axes[0].term("N").value
    """

    def deviations(self) -> pd.DataFrame:
        """Every Allan deviation with its bounds, a row for each averaging time."""
        return frames.frame(tables.of_deviations(self))

    def audit(self) -> pd.DataFrame:
        """Every test of the audit; empty where none was asked for."""
        made = tables.of_findings(self)
        return frames.frame(Table("", (), ()) if made is None else made)

    def plot(self) -> Figure:
        """The Allan plot."""
        return matplotlib_.canvas(figures.plot(self))

    def _glance(self) -> Glance:
        return Glance(
            title=f"Noise at rest: {self.title}",
            question=words.QUESTION,
            sentences=(*words.audit(self), *words.answer(self), *words.against(self)),
            notes=tuple(words.notes(self)),
            table=tables.of_terms(self),
            figure=figures.plot(self),
            more="More: .table(), .deviations(), .audit(), .plot(), .axes",
        )
