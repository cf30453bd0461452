"""What ``sensor`` gives to Python: sheets, and the answer for one reading, that show themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from simcompare.errors import UnknownName
from simcompare.reports.render import frames, matplotlib_
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.sensor import figures, page, tables, words
from simcompare.results.records.sensor import SensorList, SensorReading

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class SensorSheets(Shown, SensorList):
    """All data sheets; ``table()`` has a row for each sensor."""

    def _glance(self) -> Glance:
        return Glance(
            "Data sheets of sensors",
            table=tables.of_sheets(self),
            more="More: simcompare.sensor(NAME)",
        )


@dataclass(frozen=True, kw_only=True, repr=False)
class SensorAnswer(Shown, SensorReading):
    """How uncertain one reading is before calibration.

    ::

        found = simcompare.sensor("mpu6050")
        found.u
        found.table()
        found.plot()
    """

    def drawn(self) -> pd.DataFrame:
        """The drawn devices, a row for each axis; empty where none were asked for."""
        return frames.frame(tables.of_devices(self))

    def plot(self, name: str = "shares") -> Figure:
        """A figure: "shares" of the terms, or the "readings" of drawn devices.

        Raises:
            UnknownName: another one.
        """
        known = {"shares": figures.shares, "readings": figures.readings}
        if name not in known:
            raise UnknownName("figure", name, known)
        return matplotlib_.canvas(known[name](self))

    def _glance(self) -> Glance:
        return Glance(
            title=page.title(self),
            question=page.QUESTION,
            sentences=(words.answer(self), *words.further(self)),
            table=tables.of_entries(self),
            figure=figures.shares(self),
            more="More: .u, .table(), .plot(name), .entries, .devices, .drawn()",
        )
