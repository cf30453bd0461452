"""From the YAML file of a data sheet to its parts in SI; impossible sensors are refused."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors import sheet_entries, sheet_units
from simcompare.hardware.sensors.device import REFERENCE_C
from simcompare.hardware.sensors.sheet_entries import Entry
from simcompare.hardware.sensors.sheet_file import EntryFile, PartFile, SheetFile, SourceFile, read
from simcompare.hardware.sensors.sheet_parts import PartData, Range, Settings
from simcompare.hardware.sensors.sheet_terms import QUANTITIES
from simcompare.model.yaml_file import describe

__all__ = ["document", "parts", "read", "settings"]


def document(source: SourceFile) -> str:
    """Number and revision of the maker's data sheet."""
    date = f", {source.date}" if source.date else ""
    return f"{source.document}, rev. {source.revision}{date}"


def parts(content: SheetFile, lines: Mapping[str, int], path: Path) -> dict[str, PartData]:
    """The parts of a sheet.

    Raises:
        InputError: numbers that cannot be read, or that no sensor has; all of them at once.
    """
    reader = _Reader(content, path.stem)
    found = {name: reader.part(name, part) for name, part in content.parts.items()}
    if reader.faults:
        raise InputError(str(path), describe(reader.faults, lines))
    return {name: part for name, part in found.items() if part is not None}


class _Reader:
    """Reads a sheet and keeps every fault with its place."""

    def __init__(self, content: SheetFile, sheet: str) -> None:
        self.content, self.sheet = content, sheet
        self.faults: dict[str, str] = {}

    def part(self, name: str, given: PartFile) -> PartData | None:
        """A part; ``None`` where it has faults."""
        place = f"parts.{name}"
        before = len(self.faults)
        unit = QUANTITIES[given.measures]
        axes = "xyz" if given.axes == 3 else "x"
        ranges = {key: self._range(place, key, given, unit) for key in given.ranges}
        rates = self._frequencies(f"{place}.rates", given.rates)
        bandwidths = self._frequencies(f"{place}.bandwidths", given.bandwidths)
        reading = self._try(f"{place}.reading", lambda: sheet_units.amount(given.reading, unit))
        counted = ranges.get(given.usual.range)
        terms = self._terms(place, given, unit, axes, counted.count if counted else 0.0)
        usual = self._usual(place, given, rates, bandwidths)
        self._check_reading(place, given, reading, counted)
        if len(self.faults) > before or usual is None or reading is None:
            return None
        return PartData(
            name=name, sheet=self.sheet, chip=self.content.name, measures=given.measures,
            unit=unit, axes=axes, reading=reading, reading_text=given.reading,
            ranges={key: one for key, one in ranges.items() if one is not None},
            rates_Hz=rates,
            any_rate=given.rates_between,
            bandwidths_Hz=bandwidths,
            bandwidth_per_rate=given.bandwidth_per_rate or math.nan,
            poles=given.poles, page=_page(given.page), confirmed=given.confirmed,
            usual=usual, terms=terms,
        )  # fmt: skip

    def _check_reading(
        self, place: str, given: PartFile, reading: float | None, usual: Range | None
    ) -> None:
        """The reading at which its uncertainty is told must be one that the usual range has."""
        if reading is not None and usual is not None and abs(reading) > usual.full_scale:
            self.faults[f"{place}.reading"] = (
                f"{given.reading} is beyond the usual range {usual.name}; expected one within it"
            )

    def _try(self, place: str, reading: Callable[[], float]) -> float | None:
        try:
            return reading()
        except ValueError as error:
            self.faults[place] = str(error)
            return None

    def _frequencies(self, place: str, texts: Sequence[str]) -> tuple[float, ...]:
        read = (
            self._try(f"{place}.{i}", partial(_frequency, text)) for i, text in enumerate(texts)
        )
        return tuple(one for one in read if one is not None)

    def _range(self, place: str, name: str, given: PartFile, unit: str) -> Range | None:
        one = given.ranges[name]
        full = self._try(
            f"{place}.ranges.{name}.full_scale",
            lambda: _above_0(one.full_scale, sheet_units.amount(one.full_scale, unit)),
        )
        count: float | None = 0.0
        if one.count is not None:
            text = one.count
            count = self._try(f"{place}.ranges.{name}.count", lambda: sheet_units.step(text, unit))
        if full is None or count is None:
            return None
        if count > full:
            self.faults[f"{place}.ranges.{name}.count"] = (
                f"one count, {one.count}, is more than the full scale {one.full_scale}"
            )
        return Range(name, full, count, one.count or "", _page(one.page), one.confirmed)

    def _terms(
        self, place: str, given: PartFile, unit: str, axes: str, count: float
    ) -> dict[str, Entry]:
        found: dict[str, Entry] = {}
        for number, one in enumerate(given.entries):
            here = f"{place}.entries.{number}"
            faults = [*sheet_entries.faults_of_kind(one), *_faults_of_place(one, given, axes)]
            for name, sentence in faults:
                self.faults[f"{here}.{name}" if name else here] = sentence
            if faults:
                continue
            try:
                entry = sheet_entries.entry(one, unit, axes, count, document(self.content.source))
            except ValueError as error:
                name, _, sentence = str(error).partition(": ")
                self.faults[f"{here}.{name}"] = sentence
                continue
            if entry.name in found or _overlaps(entry, found, given):
                self.faults[here] = f"{one.term} of these axes and ranges stands twice; keep one"
            found[entry.name] = entry
        return found

    def _usual(
        self, place: str, given: PartFile, rates: Sequence[float], bandwidths: Sequence[float]
    ) -> tuple[str, float, float] | None:
        usual = given.usual
        here = f"{place}.usual"
        if usual.range not in given.ranges:
            known = ", ".join(given.ranges)
            self.faults[f"{here}.range"] = f"no range is called {usual.range!r}; known: {known}"
        rate = self._try(f"{here}.rate", lambda: _frequency(usual.rate))
        if rate is None:
            return None
        if usual.bandwidth is None:
            width: float | None = rate * (given.bandwidth_per_rate or math.inf)
        else:
            text = usual.bandwidth
            width = self._try(f"{here}.bandwidth", lambda: _frequency(text))
        if width is None:
            return None
        self._check_usual(here, rate, width, rates, bandwidths, given)
        return usual.range, rate, width

    def _check_usual(
        self, here: str, rate: float, width: float,
        rates: Sequence[float], bandwidths: Sequence[float], given: PartFile,
    ) -> None:  # fmt: skip
        """Usual settings are settings that the sensor has."""
        is_there = min(rates, default=0) <= rate <= max(rates, default=0)
        if rates and not (is_there if given.rates_between else rate in rates):
            self.faults[f"{here}.rate"] = f"{rate:g} Hz is none of the rates above"
        if math.isfinite(width) and width > rate / 2 * (1 + 1e-9):
            self.faults[f"{here}.bandwidth"] = _above_nyquist(width, rate)
        elif bandwidths and width not in bandwidths:
            self.faults[f"{here}.bandwidth"] = f"{width:g} Hz is none of the bandwidths above"


def _page(page: int | str) -> str:
    return f"p. {page}" if isinstance(page, int) else page


def _faults_of_place(one: EntryFile, given: PartFile, axes: str) -> Iterator[tuple[str, str]]:
    if one.axes is not None and not set(one.axes) <= set(axes):
        yield "axes", f"{one.axes!r} are not axes of this part; it has {axes}"
    for name in one.ranges:
        if name not in given.ranges:
            yield "ranges", f"no range is called {name!r}; known: {', '.join(given.ranges)}"


def _overlaps(entry: Entry, found: Mapping[str, Entry], given: PartFile) -> bool:
    return any(
        other.term == entry.term and other.holds_for(name, axis) and entry.holds_for(name, axis)
        for other in found.values()
        for name in given.ranges
        for axis in entry.axes
    )


def _frequency(text: str) -> float:
    return _above_0(text, sheet_units.amount(text, "Hz"))


def _above_0(text: str, value: float) -> float:
    if not value > 0:
        raise ValueError(f"{text!r} is not above 0")
    return value


def _above_nyquist(width_Hz: float, rate_Hz: float) -> str:
    return (
        f"{width_Hz:g} Hz is above half the rate, {rate_Hz / 2:g} Hz: noise and motion beyond it"
        " would come back at wrong frequencies; choose a lower bandwidth or a higher rate"
    )


def settings(
    part: PartData,
    range: str | None = None,
    rate_Hz: float | None = None,
    bandwidth_Hz: float | None = None,
    temperature_C: float = REFERENCE_C,
) -> Settings:
    """Settings that a part has; the usual ones where ``None``.

    Raises:
        UnknownName: no such range.
        InputError: a rate or a bandwidth that it does not have.
    """
    name = _range_name(part, part.usual[0] if range is None else range)
    rate = part.usual[1] if rate_Hz is None else rate_Hz
    low, high = min(part.rates_Hz), max(part.rates_Hz)
    where = f"{part.chip} {part.name}"
    if part.any_rate and not low <= rate <= high:
        raise InputError(where, [f"a rate of {rate:g} Hz is not from {low:g} to {high:g} Hz"])
    if not part.any_rate and rate not in part.rates_Hz:
        known = ", ".join(f"{one:g}" for one in part.rates_Hz)
        raise InputError(where, [f"it has no rate of {rate:g} Hz; it has {known} Hz"])
    width = _width(part, rate, bandwidth_Hz, where)
    return Settings(part.ranges[name], rate, width, part.poles, temperature_C)


def _range_name(part: PartData, given: str) -> str:
    """The name of a range, however its sign, spaces and unit are written."""
    wanted = _plain(given)
    alike = [name for name in part.ranges if _plain(name) == wanted]
    # a number alone says enough where only one range begins with it
    alike = alike or [name for name in part.ranges if name.split()[0] == wanted]
    if len(alike) != 1:
        raise UnknownName(f"range of {part.chip} {part.name}", given, part.ranges)
    return alike[0]


def _plain(text: str) -> str:
    return text.replace(" ", "").replace("±", "").lower()


def _width(part: PartData, rate: float, given: float | None, where: str) -> float:
    """Bandwidth in use; without a wish the usual one, or the widest that the rate allows."""
    if given is None:
        if not math.isnan(part.bandwidth_per_rate):
            return rate * part.bandwidth_per_rate
        if part.usual[2] <= rate / 2 or math.isinf(part.usual[2]):
            return part.usual[2]
        fitting = [one for one in part.bandwidths_Hz if one <= rate / 2]
        given = max(fitting, default=min(part.bandwidths_Hz, default=rate / 2))
    if part.bandwidths_Hz and given not in part.bandwidths_Hz:
        known = ", ".join(f"{one:g}" for one in part.bandwidths_Hz)
        raise InputError(where, [f"it has no bandwidth of {given:g} Hz; it has {known} Hz"])
    if given > rate / 2:
        raise InputError(where, [_above_nyquist(given, rate)])
    if not given > 0:
        raise InputError(where, [f"a bandwidth of {given:g} Hz is not above 0"])
    return given
