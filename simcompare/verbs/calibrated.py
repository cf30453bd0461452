"""What ``calibrate`` gives to Python: a calibration that shows itself and corrects readings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from simcompare.model.trajectory import Array
from simcompare.reports.calibration import figures, page, tables, words
from simcompare.reports.render import matplotlib_
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.results.records.calibration import CalibrationRecord

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, repr=False)
class Calibrated(Shown, CalibrationRecord):
    """A calibration.

    A notebook shows it. Besides::

        found = simcompare.calibrate("poses.csv")
        found.apply(readings)  # corrected
        found.u(readings)  # standard uncertainties of that
        found.table()
        found.plot()
    """

    def apply(self, values: ArrayLike) -> Array:
        """Corrected readings S⁻¹·(Y - O) of readings (k,) or (n, k).

        Raises:
            InputError: another number of axes.
        """
        return self.calibration.apply(values)

    def u(self, values: ArrayLike, u_reading: ArrayLike = 0.0) -> Array:
        """Standard uncertainties of corrected readings, in the shape of the readings.

        Args:
            values: readings (k,) or (n, k).
            u_reading: that of a reading itself by its noise, one number or (k,).

        Raises:
            InputError: another number of axes.
        """
        return self.calibration.u(values, u_reading)

    def plot(self) -> Figure:
        """What poses are off by, before and after."""
        return matplotlib_.canvas(figures.of(self))

    def _glance(self) -> Glance:
        place = "" if self.folder is None else f". Stored in {self.folder}"
        return Glance(
            title=page.title(self),
            question=page.QUESTION,
            sentences=tuple(words.answer(self)),
            table=tables.terms(self),
            notes=(words.notes(self)[0],),
            figure=figures.of(self),
            more=f"More: .apply(values), .u(values), .table(), .plot(){place}",
        )
