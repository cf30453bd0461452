"""One sensor of a chip as its data sheet describes it, and the settings that it was read with."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from simcompare.hardware.sensors.low_pass import noise_bandwidth
from simcompare.hardware.sensors.sheet_entries import Entry


@dataclass(frozen=True)
class Range:
    """One full scale.

    Attributes:
        name: such as "2 g".
        full_scale: where readings are cut off, SI.
        count: size of one count, SI; 0 where it is not stated.
        text: the size of one count as the sheet states it.
        page: page or table of the source.
        confirmed: whether it was read in the maker's own text.
    """

    name: str
    full_scale: float
    count: float
    text: str
    page: str
    confirmed: bool


@dataclass(frozen=True)
class Settings:
    """What a sensor is set to.

    Attributes:
        range: its full scale.
        rate_Hz: output data rate.
        bandwidth_Hz: -3 dB; infinite where nothing is smoothed.
        poles: of the low-pass.
        temperature_C: of the device.
    """

    range: Range
    rate_Hz: float
    bandwidth_Hz: float
    poles: int
    temperature_C: float

    @property
    def noise_bandwidth(self) -> float:
        """Width [Hz] of a sharp filter that lets as much white noise through."""
        return noise_bandwidth(self.bandwidth_Hz, self.poles, self.rate_Hz)


@dataclass(frozen=True)
class PartData:
    """One sensor of a chip.

    Attributes:
        name: such as "accelerometer".
        sheet: name of the sheet.
        chip: name of the chip.
        measures: the quantity.
        unit: its SI unit.
        axes: letters of its axes.
        reading: at which its uncertainty is told, SI.
        reading_text: the same as the file states it.
        ranges: name -> full scale.
        rates_Hz: output data rates that it has, or the lowest and the highest.
        any_rate: whether any rate between them can be set.
        bandwidths_Hz: bandwidths that it has; empty where they follow from the rate or are none.
        bandwidth_per_rate: bandwidth as a part of the rate; ``nan`` where it is none.
        poles: of the low-pass.
        page: page or table of rates and bandwidths.
        confirmed: whether these were read in the maker's own text.
        usual: name of the range, rate and bandwidth where none are given.
        terms: name -> line of the sheet.
    """

    name: str
    sheet: str
    chip: str
    measures: str
    unit: str
    axes: str
    reading: float
    reading_text: str
    ranges: Mapping[str, Range]
    rates_Hz: tuple[float, ...]
    any_rate: bool
    bandwidths_Hz: tuple[float, ...]
    bandwidth_per_rate: float
    poles: int
    page: str
    confirmed: bool
    usual: tuple[str, float, float]
    terms: Mapping[str, Entry]

    def entry(self, term: str, range_name: str, axis: str) -> Entry | None:
        """The line that states a term of an axis at a range."""
        fitting = (
            one
            for one in self.terms.values()
            if one.term == term and one.holds_for(range_name, axis)
        )
        return next(fitting, None)

    def noise_bandwidth(self, bandwidth_Hz: float) -> float:
        """Noise bandwidth of its low-pass [Hz], at the rate that belongs to it, if one does."""
        tied = not math.isnan(self.bandwidth_per_rate)
        rate_Hz = bandwidth_Hz / self.bandwidth_per_rate if tied else math.inf
        return noise_bandwidth(bandwidth_Hz, self.poles, rate_Hz)
