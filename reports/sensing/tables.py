"""Tables of drawn devices, and of how far their readings are off."""

from __future__ import annotations

from simcompare.notation import capital
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.run import runs
from simcompare.reports.sensing import words, zones
from simcompare.results.records.sensing import SensorRecord, SourceDeviation

_DRAWN_COLUMNS = (
    Column("Axis", text=True, nowrap=True), Column("This device"), Column("Unit", text=True),
    Column("Any device", text=True), Column("Stated", text=True), Column("Where", text=True),
)  # fmt: skip
_DRAWN_NOTE = (
    "Each term is drawn once for the device, from what is known of any device; noise is drawn for"
    " every sample. u is the standard uncertainty."
)


def drawn_table(sensor: SensorRecord) -> Table:
    """The numbers of a device beside what is known of any device, and where that stands."""
    if sensor.zones is not None:
        return zones.numbers_table(sensor)
    groups: dict[str, list[tuple[str, ...]]] = {}
    for term in sensor.terms:
        value, known, unit = words.value_words(term)
        where = f"{term.source}{'' if term.confirmed else ' *'}"
        row = (term.axis or "–", value, unit, known, term.says, where)
        groups.setdefault(term.title, []).append(row)
    note = _DRAWN_NOTE
    if not all(term.confirmed for term in sensor.terms):
        note += words.NOT_CONFIRMED
    return Table(
        f"The device that reads {sensor.signal}",
        _DRAWN_COLUMNS,
        tuple(Group(capital(title), tuple(rows)) for title, rows in groups.items()),
        note,
    )


def deviation_table(sensor: SensorRecord) -> Table:
    """How far the reading of every source is off, axis by axis."""
    if sensor.zones is not None:
        return zones.deviation_table(sensor)
    unit = words.unit_words(sensor.unit).strip()
    behind = f" ({unit})" if unit else ""
    axes = sensor.deviations[0].axes if sensor.deviations else ()
    letters = [one.axis for one in axes]
    columns = [Column("Source", text=True, nowrap=True), Column("Level", text=True)]
    for head in ("Mean off", "Scatter", "rms off"):
        over = f"{head}{behind}" if letters[1:] else ""
        columns += [Column(letter if over else f"{head}{behind}", over=over) for letter in letters]
    columns += [Column("Saturated")]
    rows = tuple(_row(one) for one in sensor.deviations)
    note = "Measured minus ideal, over all samples of the nominal repeat."
    return Table(f"How far {sensor.signal} is off", tuple(columns), (Group("", rows),), note)


def _row(one: SourceDeviation) -> tuple[str, ...]:
    means = (words.signed(axis.mean) for axis in one.axes)
    sizes = (numbers.plain(axis.scatter, 3) for axis in one.axes)
    rms = (numbers.plain(axis.rms, 3) for axis in one.axes)
    cut = sum(axis.saturated for axis in one.axes)
    level = runs.mode_words(one.contact) if one.contact else "–"
    return (one.source, level, *means, *sizes, *rms, f"{cut} of {one.samples * len(one.axes)}")
