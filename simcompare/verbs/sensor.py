"""The verb ``sensor``: what a data sheet says, and how uncertain that makes a reading."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from simcompare import units
from simcompare.arguments import checked
from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors import data_sheet, drawing, reading_uncertainty, sheet_units
from simcompare.hardware.sensors.data_sheet import DataSheet, Part
from simcompare.hardware.sensors.device import REFERENCE_C, Device
from simcompare.hardware.sensors.reading_uncertainty import CrossCheck, Drawn, Share, Situation
from simcompare.hardware.sensors.sheet_entries import Entry
from simcompare.hardware.sensors.sheet_parts import Settings
from simcompare.hardware.sensors.sheet_rules import RULE_OF_KIND, RULES
from simcompare.model.sensor_errors import COLDEST_C, HOTTEST_C
from simcompare.results.records.calibration import rows_of
from simcompare.results.records.sensor import (
    CheckRow,
    DeviceRow,
    EntryRow,
    RuleRow,
    SheetRow,
)
from simcompare.verbs.sensor_shown import SensorAnswer, SensorSheets

#: devices that are drawn to find the uncertainty a second time
DRAWS = 10_000
#: bins of the histogram of what they read
BINS = 40
#: devices that can be asked for as a table
MAX_DEVICES = 100_000
_TEMPLATE = Path(data_sheet.__file__).with_name("sheet_template.yaml")


@checked
def sensor(
    name: str | Path | None = None,
    *,
    part: str | None = None,
    range: str | None = None,
    rate: str | float | None = None,
    bandwidth: str | float | None = None,
    temperature: float = REFERENCE_C,
    reading: str | float | None = None,
    across: str | float = 0.0,
    axis: str | None = None,
    draw: int = 0,
    seed: int = 0,
    typ_is_sigma: float = 1.0,
) -> SensorSheets | SensorAnswer:
    """What a data sheet says, and how uncertain one reading is before calibration.

    ::

        simcompare.sensor()                      # all sheets
        found = simcompare.sensor("mpu6050")
        found.u                                  # combined standard uncertainty, SI
        found.table()                            # the lines of the sheet
        simcompare.sensor("mpu6050", part="gyroscope", bandwidth="98Hz", draw=5).devices

    Args:
        name: of a sheet, or a YAML file of your own; all sheets where it is left out.
        part: of a chip with several sensors, such as "gyroscope"; the first where left out.
        range: full scale, such as "4 g"; the usual one where left out.
        rate: output data rate, such as "100Hz"; a number is in hertz.
        bandwidth: -3 dB bandwidth, such as "44Hz"; a number is in hertz.
        temperature: of the device [°C].
        reading: true value, such as "0.5 g"; a number is in SI.
        across: true value along another axis, such as "1 g"; a number is in SI.
        axis: that is read; the least certain one where left out.
        draw: how many devices are drawn and given.
        seed: of all draws.
        typ_is_sigma: which part of a typical value is one standard deviation.

    Returns:
        All sheets, or the answer for one reading; both show themselves in a notebook.

    Raises:
        UnknownName: no such sheet, part, range or axis.
        InputError: settings that the chip does not have, or a file that is no data sheet.
    """
    if name is None:
        return SensorSheets(sheets=tuple(_sheets()), rules=rules())
    _check(draw, temperature, typ_is_sigma)
    sheet = data_sheet.load(name)
    one = sheet.part(part).with_sigma(typ_is_sigma)
    settings = one.settings(
        range=range, rate_Hz=_hertz("--rate", rate), bandwidth_Hz=_hertz("--bandwidth", bandwidth),
        temperature_C=temperature,
    )  # fmt: skip
    told = one.reading_text if reading is None else _told(reading, one.unit)
    value = one.reading if reading is None else _amount("--reading", reading, one.unit)
    _check_range("--reading", value, told, settings)
    beside = _amount("--across", across, one.unit)
    _check_range("--across", beside, _told(across, one.unit), settings)
    axis = _worst(one, value, beside, settings) if axis is None else _axis(one, axis)
    now = Situation(axis, value, beside, settings)
    return _answer(sheet, one, now, told, draw, seed, typ_is_sigma)


def rules() -> tuple[RuleRow, ...]:
    """How values of a data sheet become distributions."""
    return tuple(
        RuleRow(
            rule.name,
            tuple(kind for kind, name in RULE_OF_KIND.items() if name == rule.name),
            rule.words,
            rule.source,
        )
        for rule in RULES.values()
    )


def template() -> str:
    """A commented YAML file to fill in."""
    return _TEMPLATE.read_text(encoding="utf-8")


def _sheets() -> list[SheetRow]:
    rows = []
    for name in data_sheet.names():
        sheet = data_sheet.load(name)
        for part in sheet.parts.values():
            confirmed = [entry.confirmed for entry in part.terms.values()]
            confirmed += [one.confirmed for one in part.ranges.values()]
            rows.append(
                SheetRow(
                    name, sheet.title, part.name, part.measures, tuple(part.ranges),
                    part.rates_Hz, part.any_rate, sheet.document, sum(confirmed),
                    len(confirmed) - sum(confirmed),
                )
            )  # fmt: skip
    return rows


def _check(draw: int, temperature: float, typ_is_sigma: float) -> None:
    faults = []
    if not 0 <= draw <= MAX_DEVICES:
        faults.append(f"--draw {draw}: expected 0 to {MAX_DEVICES} devices")
    if not COLDEST_C <= temperature <= HOTTEST_C:
        faults.append(
            f"--temperature {temperature:g}: expected {COLDEST_C:g} to {HOTTEST_C:g}, in °C"
        )
    if not 0 < typ_is_sigma <= 3:
        faults.append(f"--typ-is-sigma {typ_is_sigma:g}: expected a number above 0 and up to 3")
    if faults:
        raise InputError("sensor", faults)


def _check_range(name: str, value: float, told: str, settings: Settings) -> None:
    if not abs(value) <= settings.range.full_scale:
        fault = f"{told} is beyond the range {settings.range.name}; choose another range"
        raise InputError(name, [fault])


def _hertz(name: str, given: str | float | None) -> float | None:
    return None if given is None else units.to_si(given, "Hz", name)


def _amount(name: str, given: str | float, unit: str) -> float:
    if isinstance(given, str):
        try:
            return sheet_units.amount(given, unit)
        except ValueError as error:
            raise InputError(name, [str(error)]) from None
    return float(given)


def _told(given: str | float, unit: str) -> str:
    return given.strip() if isinstance(given, str) else f"{given:g} {units.symbol(unit)}"


def _axis(part: Part, axis: str) -> str:
    if axis not in part.axes:
        raise UnknownName(f"axis of the {part.name}", axis, part.axes)
    return axis


def _worst(part: Part, value: float, beside: float, settings: Settings) -> str:
    """The axis whose reading is the least certain, the first of equals."""
    sizes = {
        axis: reading_uncertainty.combined(
            reading_uncertainty.shares(part, Situation(axis, value, beside, settings))
        )
        for axis in part.axes
    }
    return max(sizes, key=lambda axis: sizes[axis])


def _answer(
    sheet: DataSheet, part: Part, now: Situation, told: str, draw: int, seed: int, sigma: float
) -> SensorAnswer:
    settings = now.settings
    rows = reading_uncertainty.shares(part, now)
    u = reading_uncertainty.combined(rows)
    if not u:
        raise InputError(
            sheet.name, [f"its {part.name} has no uncertainty at all at these settings"]
        )
    drawn = reading_uncertainty.drawn(part, now, DRAWS, seed)
    two_sigma = reading_uncertainty.combined(
        reading_uncertainty.shares(part.with_sigma(0.5 * sigma), now)
    )
    return SensorAnswer(
        name=sheet.name, chip=sheet.title, about=sheet.about, maker=sheet.maker,
        document=sheet.document, read=sheet.read, note=sheet.note, part=part.name,
        parts=tuple(sheet.parts), measures=part.measures, unit=part.unit,
        axis=now.axis if len(part.axes) > 1 else "", reading=now.reading, reading_text=told,
        across=now.across, range=settings.range.name, full_scale=settings.range.full_scale,
        rate_Hz=settings.rate_Hz, bandwidth_Hz=settings.bandwidth_Hz,
        noise_bandwidth_Hz=settings.noise_bandwidth, poles=settings.poles,
        temperature_C=settings.temperature_C, typ_is_sigma=sigma,
        entries=tuple(_entries(part, now, rows, u)), u=u, **_of_draws(drawn, u),
        u_if_two_sigma=two_sigma,
        checks=tuple(map(_check_row, reading_uncertainty.cross_checks(part))),
        devices=tuple(_devices(part, now, draw, seed)), seed=seed,
    )  # fmt: skip


def _of_draws(drawn: Drawn, u: float) -> dict[str, Any]:
    counts, edges = np.histogram(drawn.values, BINS)
    return {
        "u_drawn": drawn.u,
        "draws": len(drawn.values),
        "agrees": reading_uncertainty.agree(u, drawn),
        "mean_error": drawn.mean_error,
        "low": drawn.low,
        "high": drawn.high,
        "saturated": drawn.saturated,
        "edges": tuple(edges.tolist()),
        "counts": tuple(counts.tolist()),
    }


def _entries(part: Part, now: Situation, rows: list[Share], u: float) -> list[EntryRow]:
    """All lines, those in use first in the order of the sheet, and the resolution of the range."""
    by_name = {row.entry.name: row for row in rows if row.entry is not None}
    found = []
    for entry in part.terms.values():
        if entry.ranges and now.settings.range.name not in entry.ranges:
            continue
        used = entry.holds_for(now.settings.range.name, now.axis)
        found.append(_entry(entry, by_name.get(entry.name) if used else None, used, u))
    resolution = next((row for row in rows if row.entry is None), None)
    if resolution is not None:
        found.append(_resolution(part, now, resolution, u))
    return found


def _entry(entry: Entry, row: Share | None, used: bool, u: float) -> EntryRow:
    known = entry.distribution
    size = entry.stated.typ if known.kind == "fixed" else known.u
    return EntryRow(
        name=entry.name, term=entry.term, title=entry.title, says=entry.says, text=entry.text,
        kind=entry.kind, axes=entry.axes, page=entry.page, source=entry.source,
        confirmed=entry.confirmed, used=used, rule=entry.rule.name, distribution=known.kind,
        u=size, unit=entry.unit, contribution=None if row is None else row.u,
        share=None if row is None else (row.u / u) ** 2, note=entry.note,
    )  # fmt: skip


def _resolution(part: Part, now: Situation, row: Share, u: float) -> EntryRow:
    chosen = now.settings.range
    return EntryRow(
        name="resolution", term="resolution", title=row.title, says="size of one count",
        text=chosen.text, kind="resolution", axes=part.axes, page=chosen.page, source="",
        confirmed=chosen.confirmed, used=True, rule=row.rule.name, distribution="rectangular",
        u=row.u, unit=sheet_units.written(part.unit), contribution=row.u,
        share=(row.u / u) ** 2, note="",
    )  # fmt: skip


def _check_row(check: CrossCheck) -> CheckRow:
    return CheckRow(
        check.density.text, check.entry.text, check.rms, check.expected, check.sharp,
        check.entry.page,
    )  # fmt: skip


def _devices(part: Part, now: Situation, draw: int, seed: int) -> list[DeviceRow]:
    if not draw:
        return []
    return [_device(one) for one in drawing.many(part, now.settings, seed, draw)]


def _device(one: Device) -> DeviceRow:
    per_axis = one.offset, one.nonlinearity, one.sensitivity_per_K, one.offset_per_K
    return DeviceRow(rows_of(one.sensitivity), *(tuple(term.tolist()) for term in per_axis))
