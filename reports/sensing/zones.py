"""What a range sensor of many zones told: a picture beside the ideal one, and tables."""

from __future__ import annotations

import math

import numpy as np

from simcompare import notation, units
from simcompare.hardware.sensors.drawn_zones import ZoneReading
from simcompare.hardware.sensors.multizone import NOTHING
from simcompare.model.trajectory import Array
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Figure, Series
from simcompare.reports.render.styles import Style
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.run import runs
from simcompare.reports.run.range_pictures import panel
from simcompare.reports.sensing import words
from simcompare.results.records.sensing import SensorRecord, SourceDeviation

_NOTHING = Style("#D55E00", marker="x")
_DOUBTFUL = Style("#0072B2", marker="triangle-up", hollow=True)
_NUMBERS = (
    Column("The sheet says", text=True), Column("Value"), Column("Unit", text=True),
    Column("Where", text=True),
)  # fmt: skip
_DEVIATIONS = (
    Column("Source", text=True, nowrap=True), Column("Level", text=True), Column("Frames"),
    Column("Median off (m)"), Column("68 % within ± (m)"), Column("rms off (m)"),
    Column("See nothing"), Column("Not trusted"),
)  # fmt: skip


def frame_figure(signal: str, reading: ZoneReading, whose: str) -> Figure:
    """A frame beside the ideal picture, in one scale: the last of those with the most marks.

    Args:
        signal: such as "eye.range_m".
        reading: of the signal.
        whose: whose motion it is.
    """
    frames, wrong = reading.frames, (~reading.frames.valid).sum(axis=1)
    shown = int(np.flatnonzero(wrong == wrong.max())[-1])
    ideal, valid = reading.ideal[shown], frames.valid[shown]
    told = np.where(valid, frames.range_m[shown], np.nan)
    far = float(np.nanmax([ideal, told]))
    nothing = frames.status[shown] == NOTHING
    marks = (
        *_marks("nothing found", nothing, _NOTHING),
        *_marks("found, but not to be trusted", ~nothing & ~valid, _DOUBTFUL),
    )
    panels = (
        panel("ideal", ideal, far, ()),
        panel("read", told, far, marks, bar="distance (m)"),
    )
    caption = (
        f"{notation.capital(whose)} at {reading.time_s[shown]:.3g} s. Each cell is a zone, as the"
        " sensor sees it, with its distance in m along the axis; near ones are dark. A zone with a"
        " mark has no distance that can be trusted"
    )
    caption += "; of all frames this one has most of them." if marks else "; here are none."
    name = f"sensor-{signal.replace('.', '-')}"
    return Figure(name, f"What {signal} reads", caption, panels, height=1.2)


def _marks(label: str, where: Array, style: Style) -> tuple[Series, ...]:
    """A mark in each of these zones."""
    side = math.isqrt(len(where))
    rows, columns = np.divmod(np.flatnonzero(where), side)
    if not len(rows):
        return ()
    return (Series(label, columns, rows, style, points=True, line=False),)


def numbers_table(sensor: SensorRecord) -> Table:
    """Every number that the device is made of, and where it stands."""
    rows = []
    for term in sensor.terms:
        is_part = term.unit == ""
        value = f"{numbers.plain(100 * term.value if is_part else term.value, 3)}"
        unit = "%" if is_part else "" if term.unit == "1" else units.symbol(term.unit)
        says = term.says
        if term.u:
            any_device = f"any device: u = {100 * term.u:.2g} %"
            says = f"What stays with this device far away, {term.axis}; {any_device}"
        where = f"{term.source}{'' if term.confirmed else ' *'}"
        rows.append((says, value, unit, where))
    note = (
        "What stays with the device is drawn once for each zone, scatter in each frame; the rest is"
        " the same for all of its kind."
    )
    if not all(term.confirmed for term in sensor.terms):
        note += words.NOT_CONFIRMED
    title = f"The device that reads {sensor.signal}"
    return Table(title, _NUMBERS, (Group("", tuple(rows)),), note)


def deviation_table(sensor: SensorRecord) -> Table:
    """How far what every source shows is off, and how much of it is not there."""
    note = (
        "Measured minus ideal, where it can be trusted (status 5, 6 and 9), over all frames of the"
        " nominal repeat; a frame is half a period old when it is told. A zone with an edge in it"
        " reads the mean of two things, where the ideal ray sees one of them; such zones are far"
        " off, and make most of the rms. See nothing: status 255."
    )
    rows = tuple(map(_row, sensor.deviations))
    return Table(f"How far {sensor.signal} is off", _DEVIATIONS, (Group("", rows),), note)


def _row(one: SourceDeviation) -> tuple[str, ...]:
    whole = sum(one.statuses.values())
    shares = (numbers.percent(count / whole) for count in words.counts_of(one))
    level = runs.mode_words(one.contact) if one.contact else "–"
    if not one.axes:
        return (one.source, level, str(one.samples), "–", "–", "–", *shares)
    axis = one.axes[0]
    assert axis.median is not None
    assert axis.half_68 is not None
    sizes = (numbers.plain(size, 3) for size in (axis.half_68, axis.rms))
    return (one.source, level, str(one.samples), words.signed(axis.median), *sizes, *shares)
