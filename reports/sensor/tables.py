"""Tables of data sheets: all of them, the lines of one, the rules, and drawn devices."""

from __future__ import annotations

from simcompare import notation
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results.records.sensor import (
    DeviceRow,
    EntryRow,
    RuleRow,
    SensorList,
    SensorReading,
    SheetRow,
)
from simcompare.units import symbol

_DISTRIBUTIONS = {"truncated_normal": "normal, cut off", "fixed": "exact"}


def of_sheets(found: SensorList) -> Table:
    """All sheets, a row for each sensor."""
    columns = (
        Column("Sheet", text=True, nowrap=True), Column("Sensor", text=True),
        Column("Measures", text=True), Column("Ranges", text=True),
        Column("Rates (Hz)", text=True), Column("Confirmed"), Column("Not confirmed"),
    )  # fmt: skip
    rows = tuple(_sheet(row) for row in found.sheets)
    return Table("Data sheets", columns, (Group("", rows),))


def _sheet(row: SheetRow) -> tuple[str, ...]:
    rates = [f"{rate:g}" for rate in sorted(row.rates_Hz)]
    told = f"{rates[0]} to {rates[-1]}" if row.any_rate else f"{len(rates)} up to {rates[-1]}"
    return (
        row.name, row.part.replace("_", " "), row.measures, ", ".join(row.ranges), told,
        str(row.confirmed), str(row.unconfirmed),
    )  # fmt: skip


#: words of the table that a legend explains
WORDS = ("typical value", "distribution", "u", "noise density", "confirmed")


def of_entries(found: SensorReading) -> Table:
    """The lines of one sheet, and what each adds to the uncertainty."""
    columns = (
        Column("Term", text=True),
        Column("Name in the sheet", text=True, spare=True), Column("The sheet says", text=True),
        Column("Kind", text=True, spare=True), Column("Page", text=True, nowrap=True),
        Column("Rule", text=True, spare=True), Column("Distribution", text=True),
        Column("u of the term", text=True, spare=True),
        Column(f"u of the reading ({symbol(found.unit)})"),
        Column("Share (%)"), Column("Confirmed", text=True),
    )  # fmt: skip
    axes = max((row.axes for row in found.entries), key=len)
    used = tuple(_entry(row, axes) for row in found.entries if row.used)
    other = tuple(_entry(row, axes) for row in found.entries if not row.used)
    groups = [Group("", used)]
    if other:
        groups.append(Group("Not used here", other))
    return Table("What the sheet says", columns, tuple(groups))


def _entry(row: EntryRow, axes: str) -> tuple[str, ...]:
    one, every = row.distribution, row.axes == axes
    return (
        row.title if every else f"{row.title}, {row.axes}", row.says, row.text,
        row.kind.replace("_", " and "), row.page, row.rule,
        "normal" if row.rule == "density" else _DISTRIBUTIONS.get(one, one),
        f"{numbers.plain(row.u, 3)} {row.unit}".strip(),
        numbers.plain(row.contribution, 2) if row.used else "–",
        _percent(row.share),
        "yes" if row.confirmed else "no",
    )  # fmt: skip


def _percent(share: float | None) -> str:
    """A share; what is too small to matter is only said to be so."""
    if share is None:
        return "–"
    return "< 0.1" if 0 < share < 0.001 else notation.fixed(100 * share, 1)


def of_rules(rules: tuple[RuleRow, ...]) -> Table:
    """How values become distributions."""
    columns = (
        Column("Rule", text=True, nowrap=True), Column("Kinds of values", text=True),
        Column("In words", text=True), Column("Source", text=True),
    )  # fmt: skip
    rows = tuple(
        (row.name, ", ".join(row.kinds) or "where a sheet asks for it", row.words, row.source)
        for row in rules
    )
    return Table("Rules", columns, (Group("", rows),))


def of_devices(found: SensorReading) -> Table:
    """Drawn devices, a row for each axis."""
    unit = symbol(found.unit)
    columns = (
        Column("Device"), Column("Axis", text=True), Column("Sensitivity"),
        Column("Cross-axis (%)", text=True), Column(f"Offset ({unit})"),
        Column("Non-linearity (% of full scale)"), Column("Sensitivity with temperature (%/K)"),
        Column(f"Offset with temperature ({unit}/K)"),
    )  # fmt: skip
    rows = tuple(row for number, one in enumerate(found.devices) for row in _device(number, one))
    return Table("Drawn devices", columns, (Group("", rows),))


def _device(number: int, one: DeviceRow) -> list[tuple[str, ...]]:
    axes = "xyz"[: len(one.offset)]
    names = axes if len(axes) > 1 else "–"
    rows: list[tuple[str, ...]] = []
    for i, axis in enumerate(names):
        across = [100 * value for j, value in enumerate(one.sensitivity[i]) if j != i]
        rows.append(
            (
                str(number), axis, numbers.plain(one.sensitivity[i][i], 5),
                ", ".join(numbers.plain(value, 2) for value in across) or "–",
                numbers.plain(one.offset[i], 3), numbers.plain(100 * one.nonlinearity[i], 2),
                numbers.plain(100 * one.sensitivity_per_K[i], 2),
                numbers.plain(one.offset_per_K[i], 2),
            )
        )  # fmt: skip
    return rows
