"""What ``sense`` gives to Python: readings that show themselves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from simcompare.arguments import checked
from simcompare.errors import UnknownName
from simcompare.hardware.sensors.device import Device
from simcompare.hardware.sensors.drawn_zones import ZoneReading
from simcompare.hardware.sensors.error_model import Reading
from simcompare.hardware.sensors.multizone import Multizone
from simcompare.reports.render import frames, matplotlib_
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.sensing import figures, tables, words
from simcompare.results import sensing_frames
from simcompare.results.asked_sensors import Drawn
from simcompare.results.records.sensing import Sensing, SensorRecord

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure as Canvas


@dataclass(frozen=True, eq=False, repr=False)
class Sensed(Shown):
    """What a real sensor reads, beside the ideal signal.

    A notebook shows the first signal. Besides::

        read.reading.measured          # (n,) or (n, k), beside .ideal, .time_s and .saturated
        read.readings["imu.rate_rad_s"]
        read.table()                   # the drawn device beside its data sheet
        read.samples()                 # everything over time

    Attributes:
        whose: whose motion was read.
        record: what was drawn, and how far readings are off.
        drawn: the device of each signal.
        readings: signal -> reading.
    """

    whose: str
    record: Sensing
    drawn: tuple[Drawn, ...]
    readings: Mapping[str, Reading | ZoneReading]

    @property
    def reading(self) -> Reading | ZoneReading:
        """The reading of the first signal."""
        return next(iter(self.readings.values()))

    @property
    def devices(self) -> dict[str, Device | Multizone]:
        """Signal -> the device that reads it."""
        return {one.signal: one.device for one in self.drawn}

    @checked
    def table(self, signal: str | None = None) -> pd.DataFrame:
        """The numbers of a device beside what is known of any; the first one where ``None``.

        Raises:
            UnknownName: no such signal was read.
        """
        return frames.frame(tables.drawn_table(self._sensor(signal)))

    @checked
    def samples(self, signal: str | None = None) -> pd.DataFrame:
        """Time, ideal, measured and saturated, one row a sample; the first signal where ``None``.

        Of many zones one row for each zone of each frame: ideal, range, status, targets and sigma.

        Raises:
            UnknownName: no such signal was read.
        """
        import pandas as pd

        one = self._sensor(signal)
        return pd.DataFrame(sensing_frames.columns(self.readings[one.signal]))

    @checked
    def plot(self, signal: str | None = None) -> Canvas:
        """Measured beside ideal, a panel for each axis; the first signal where ``None``.

        Of many zones the last frame of those in which most is missing.

        Raises:
            UnknownName: no such signal was read.
        """
        return matplotlib_.canvas(self._figure(self._sensor(signal)))

    def _sensor(self, signal: str | None) -> SensorRecord:
        known = {one.signal: one for one in self.record.sensors}
        if signal is not None and signal not in known:
            raise UnknownName("signal that was read", signal, known)
        return known[signal] if signal is not None else self.record.sensors[0]

    def _figure(self, one: SensorRecord) -> Figure:
        return figures.reading_figure(one, self.readings[one.signal], self.whose)

    def _glance(self) -> Glance:
        first = self.record.sensors[0]
        return Glance(
            title=f"{', '.join(self.readings)} of {self.whose}, as a real sensor reads it",
            settings=f"seed {self.record.seed}",
            sentences=tuple(
                line for one in self.record.sensors for line in words.sensor_lines(one)
            ),
            table=tables.drawn_table(first) if first.terms else tables.deviation_table(first),
            notes=self.reading.notes if isinstance(self.reading, Reading) else (),
            figure=self._figure(first),
            more="More: .samples(signal), .table(signal), .plot(signal), .readings, .devices",
        )
