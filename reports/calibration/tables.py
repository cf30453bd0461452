"""Tables of a calibration."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.hardware.sensors import sheet_units
from simcompare.notation import capital, number, places
from simcompare.reports.calibration import coverage
from simcompare.reports.calibration.words import deviations
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results.records.calibration import CalibrationRecord, Rows
from simcompare.units import symbol

#: part of the whole below which a share is none
_NONE = 1e-6


def terms(record: CalibrationRecord) -> Table:
    """S and O, each with its standard uncertainty in the last digits."""
    axes = "xyz" if len(record.offset) == 3 else "p"
    columns = [Column("Axis", text=True), *(Column(f"S, {axis}") for axis in axes)]
    spoken, size = ("hPa", 100.0) if record.unit == "Pa" else sheet_units.spoken(record.unit)
    columns += [Column(f"O ({symbol(record.unit)})"), Column(f"O ({spoken})")]
    rows = tuple(
        (
            axis,
            *(number(s, u) for s, u in zip(row, u_row, strict=True)),
            number(offset, u_offset),
            number(offset / size, u_offset / size),
        )
        for axis, row, u_row, offset, u_offset in zip(
            axes, record.sensitivity, record.u_sensitivity, record.offset, record.u_offset,
            strict=True,
        )
    )  # fmt: skip
    note = (
        "A reading is S·f + O, a corrected one S⁻¹·(reading − O). Digits in brackets are standard"
        " uncertainties in the last digits."
    )
    return Table("Sensitivity and offset", tuple(columns), (Group("", rows),), note)


def truth(record: CalibrationRecord) -> Table | None:
    """Recovered beside true of a simulated device."""
    if record.truth is None:
        return None
    axes = "xyz"
    names = [f"S {row}{column}" for row in axes for column in axes] + [f"O {one}" for one in axes]
    found = [s for row in record.sensitivity for s in row] + [*record.offset]
    u = [s for row in record.u_sensitivity for s in row] + [*record.u_offset]
    true = [s for row in record.truth.sensitivity for s in row] + [*record.truth.offset]
    rows = tuple(
        (name, number(value, s), number(right, places=places(s)), f"{off:+.1f}".replace("-", "−"))
        for name, value, s, right, off in zip(
            names, found, u, true, deviations(record), strict=True
        )
    )
    columns = (Column("Term", text=True), Column("Recovered"), Column("True"), Column("Off by (u)"))
    return Table(f"Recovered and true: {record.truth.device}", columns, (Group("", rows),))


def poses(record: CalibrationRecord) -> Table:
    """What each pose is off by, before and after."""
    columns = (
        Column("Known value" if record.kind == "two-point" else "Pose", text=True),
        Column(f"As it is ({symbol(record.unit)})"),
        Column(f"Corrected ({symbol(record.unit)})"),
    )  # fmt: skip
    groups = []
    for title, fitted in (("", True), ("Took no part", False)):
        rows = tuple(
            (one.name, number(one.before, one.u_after), number(one.after, one.u_after))
            for one in record.poses
            if one.fitted is fitted
        )
        groups += [Group(title, rows)] if rows else []
    note = "Along the known direction, and of the size of f where none is known."
    return Table("What poses are off by", columns, tuple(groups), note)


def assumed(record: CalibrationRecord) -> Table:
    """What was taken as known, with its uncertainty and what it does."""
    columns = (
        Column("Taken as known", text=True), Column("Value"), Column("u"),
        Column("Unit", text=True, nowrap=True), Column("From", text=True),
        Column("Effect", text=True),
    )  # fmt: skip
    rows = tuple(
        (
            capital(one.quantity),
            number(one.value), number(one.u), "" if one.unit == "1" else symbol(one.unit),
            one.source, one.effect,
        )
        for one in record.assumptions
    )  # fmt: skip
    return Table("Assumptions", columns, (Group("", rows),))


def shares(record: CalibrationRecord) -> Table:
    """Where the uncertainty of each term comes from: largest of each kind of term."""
    kinds = coverage.kinds(record)
    units = {"offset": f" ({symbol(record.unit)})"}
    titles = (Column(capital(kind) + units.get(kind, "")) for kind in kinds)
    columns = (Column("Source", text=True), *titles)
    rows = [
        (name, *(_share(share, record.covariance, places) for places in kinds.values()))
        for name, share in record.shares.items()
    ]
    whole = record.covariance
    rows.append(("all", *(_share(whole, whole, places) for places in kinds.values())))
    note = "Standard uncertainties, the largest of each kind of term; squares add up."
    return Table("Where the uncertainty comes from", columns, (Group("", tuple(rows)),), note)


def _share(share: Rows, whole: Rows, places: Sequence[int]) -> str:
    """Largest standard uncertainty at these places, in two digits."""
    part, total = (max(rows[i][i] for i in places) ** 0.5 for rows in (share, whole))
    return numbers.plain(part, 2) if part > _NONE * total else "0"
