"""What ``sensor --json`` says of a data sheet and of a reading."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.model.plain import Finite

#: version of what is printed
FORMAT = 1


@dataclass(frozen=True)
class SheetRow:
    """One sensor of a chip in the list of all sheets.

    Attributes:
        name: of the sheet.
        chip: name of the chip.
        part: name of the sensor.
        measures: the quantity.
        ranges: names of its full scales.
        rates_Hz: output data rates, or the lowest and the highest.
        any_rate: whether any rate between these can be set.
        document: the maker's document.
        confirmed: lines that were read in the maker's own text.
        unconfirmed: lines that were not.
    """

    name: str
    chip: str
    part: str
    measures: str
    ranges: tuple[str, ...]
    rates_Hz: tuple[float, ...]
    any_rate: bool
    document: str
    confirmed: int
    unconfirmed: int


@dataclass(frozen=True)
class RuleRow:
    """How a kind of value becomes a distribution.

    Attributes:
        name: of the rule.
        kinds: of values for which it holds where a sheet states none.
        words: the rule in words.
        source: where it is written.
    """

    name: str
    kinds: tuple[str, ...]
    words: str
    source: str


@dataclass(frozen=True)
class SensorList:
    """All sheets, and the rules.

    Attributes:
        sheets: one row for each sensor of each chip.
        rules: how values become distributions.
        format: version of what is printed.
    """

    sheets: tuple[SheetRow, ...]
    rules: tuple[RuleRow, ...]
    format: int = FORMAT


@dataclass(frozen=True)
class EntryRow:
    """One line of the sheet, and what it adds to the uncertainty of the reading.

    Attributes:
        name: of the line.
        term: of the error model.
        title: the term in words.
        says: what the sheet calls it.
        text: the value as the sheet states it.
        kind: typ, max, min_max, typ_max, rms, density or resolution.
        axes: letters of its axes.
        page: page or table of the source.
        source: document and revision.
        confirmed: whether it was read in the maker's own text.
        used: whether it is a part of the error model at these settings.
        rule: name of the rule.
        distribution: kind of what is known of it.
        u: its standard uncertainty, or the density or rms of noise, in ``unit``.
        unit: SI unit of ``u``.
        contribution: to the uncertainty of the reading, in its unit; ``null`` where none.
        share: of the combined variance, 0 to 1; ``null`` where none.
        note: what was assumed.
    """

    name: str
    term: str
    title: str
    says: str
    text: str
    kind: str
    axes: str
    page: str
    source: str
    confirmed: bool
    used: bool
    rule: str
    distribution: str
    u: float
    unit: str
    contribution: float | None
    share: float | None
    note: str


@dataclass(frozen=True)
class CheckRow:
    """Two lines of the sheet that state noise in two ways.

    Attributes:
        stated: the line that is used, as the sheet states it.
        other: the line that it is held against.
        rms: what the other line states, SI.
        expected: from the used line with the filter that is assumed, SI.
        sharp: from the used line with a filter that ends at the bandwidth, SI.
        page: of the other line.
    """

    stated: str
    other: str
    rms: float
    expected: float
    sharp: float
    page: str


@dataclass(frozen=True)
class DeviceRow:
    """Numbers of one drawn device.

    Attributes:
        sensitivity: its matrix, row by row.
        offset: of each axis, SI.
        nonlinearity: of each axis, part of full scale.
        sensitivity_per_K: of each axis [1/K].
        offset_per_K: of each axis [SI/K].
    """

    sensitivity: tuple[tuple[float, ...], ...]
    offset: tuple[float, ...]
    nonlinearity: tuple[float, ...]
    sensitivity_per_K: tuple[float, ...]
    offset_per_K: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class SensorReading:
    """What a data sheet says of one reading before calibration.

    Attributes:
        name: of the sheet.
        chip: name of the chip.
        about: what the chip is.
        maker: who makes it.
        document: number and revision of the maker's data sheet.
        read: how its values were read.
        note: what else must be known of the sheet.
        part: name of the sensor.
        parts: names of all sensors of the chip.
        measures: the quantity.
        unit: its SI unit.
        axis: that is read; empty where there is only one.
        reading: true value, SI.
        reading_text: the same as it was given.
        across: true value along another axis, SI.
        range: name of the full scale.
        full_scale: SI.
        rate_Hz: output data rate.
        bandwidth_Hz: -3 dB bandwidth; ``null`` where nothing is smoothed.
        noise_bandwidth_Hz: of white noise.
        poles: of the low-pass.
        temperature_C: of the device.
        typ_is_sigma: which part of a typical value is one standard deviation.
        entries: lines of the sheet.
        u: combined standard uncertainty of the reading, first order, SI.
        u_drawn: the same from drawn devices.
        draws: how many.
        agrees: whether both agree within what that many draws can tell.
        mean_error: of the drawn readings, SI.
        low, high: ends of the middle 95 % of the drawn readings, SI.
        saturated: part of the drawn readings that is cut off.
        edges: of the bins of a histogram of the drawn readings (n + 1), SI.
        counts: drawn readings in each bin (n).
        u_if_two_sigma: combined standard uncertainty where a typical value is two standard
            deviations.
        checks: lines that state noise twice.
        devices: drawn devices, where some were asked for.
        seed: of the draws.
        format: version of what is printed.
    """

    name: str
    chip: str
    about: str
    maker: str
    document: str
    read: str
    note: str
    part: str
    parts: tuple[str, ...]
    measures: str
    unit: str
    axis: str
    reading: float
    reading_text: str
    across: float
    range: str
    full_scale: float
    rate_Hz: float
    bandwidth_Hz: Finite
    noise_bandwidth_Hz: float
    poles: int
    temperature_C: float
    typ_is_sigma: float
    entries: tuple[EntryRow, ...]
    u: float
    u_drawn: float
    draws: int
    agrees: bool
    mean_error: float
    low: float
    high: float
    saturated: float
    edges: tuple[float, ...]
    counts: tuple[int, ...]
    u_if_two_sigma: float
    checks: tuple[CheckRow, ...]
    devices: tuple[DeviceRow, ...] = ()
    seed: int = 0
    format: int = FORMAT

    @property
    def shares(self) -> tuple[EntryRow, ...]:
        """Lines that add to the uncertainty, the largest first."""
        rows = [row for row in self.entries if row.contribution]
        return tuple(sorted(rows, key=lambda row: -(row.contribution or 0.0)))

    @property
    def unconfirmed(self) -> tuple[EntryRow, ...]:
        """Lines in use that were not read in the maker's own text."""
        return tuple(row for row in self.entries if row.used and not row.confirmed)
