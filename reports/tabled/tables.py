"""Tables of a table of results: one line a source, and one line an experiment."""

from __future__ import annotations

import math
from collections.abc import Sequence

from simcompare import notation, units
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Scale, Table, scale_of
from simcompare.reports.tabled.words import amount, matters, ratio, spoken
from simcompare.results.records.tabled import Point, TabledResult, TableValidation, Verdict


def verdicts(found: TableValidation) -> Table:
    """How every source stands to the table."""
    columns = (
        Column("Source", text=True, nowrap=True),
        Column("Verdict", text=True, nowrap=True),
        Column("Measured ÷ simulated, ± 95 %"),
        Column("Within 2 u"),
        Column("Scatter (u)"),
    )
    titled = len(found.results) > 1
    groups = tuple(
        Group(spoken(result.name) if titled else "", tuple(map(_verdict, result.verdicts)))
        for result in found.results
    )
    return Table("", columns, groups)


def _verdict(one: Verdict) -> tuple[str, ...]:
    if one.ratio is None:
        return (one.source, one.status if one.status != "ok" else one.verdict, "–", "–", "–")
    within = f"{one.within} of {one.points}"
    return (one.source, one.verdict, ratio(one), within, numbers.plain(one.scatter, 2))


def rows(result: TabledResult) -> Table:
    """Every experiment: what was set and measured, and what sources say."""
    sources = [one.source for one in result.verdicts if one.points]
    names = list(dict.fromkeys(name for one in result.points for name in one.set))
    scale = _scale(result)
    unit = scale.unit(units.symbol(result.unit))
    columns = (
        Column("Line", text=True),
        *(Column(f"{spoken(name)}{_bracketed(units.unit_of(name))}") for name in names),
        Column("n"),
        Column(f"measured{unit}"),
        Column(f"u{unit}"),
        Column("residual (u)"),
        *(Column(source, over=f"simulated{unit}") for source in sources),
    )
    lines = tuple(_row(one, names, sources, scale) for one in result.points)
    return Table(f"Rows: {spoken(result.name)}", columns, (Group("", lines),))


def _scale(result: TabledResult) -> Scale:
    """Two digits of the smallest uncertainty."""
    scale = scale_of([one.measured for one in result.points])
    least = min(one.u for one in result.points) / 10.0**scale.power
    return Scale(scale.power, min(max(1 - math.floor(math.log10(least)), 0), 7))


def _row(one: Point, names: Sequence[str], sources: Sequence[str], scale: Scale) -> tuple[str, ...]:
    lines = [str(line) for line in one.lines]
    shown = ", ".join(lines) if len(lines) <= 3 else f"{lines[0]} … {lines[-1]}"
    return (
        shown,
        *(amount(one.set[name], None, units.unit_of(name)).partition(" ")[0] for name in names),
        str(one.repeats),
        scale.text(one.measured),
        scale.text(one.u),
        _residuals([one.residual(source) for source in sources]),
        *(scale.text(one.values.get(source)) for source in sources),
    )


def _residuals(values: Sequence[float | None]) -> str:
    """From the lowest to the highest of all sources; one number where they are alike."""
    known = sorted(value for value in values if value is not None)
    ends = [notation.fixed(value, 1) for value in (known[0], known[-1])] if known else ["–"]
    return " … ".join(dict.fromkeys(ends))


def told(result: TabledResult) -> Table | None:
    """What the table says of a parameter, without and with an offset."""
    if not result.told:
        return None
    first = result.told[0]
    offset = next((one.offset for one in result.told if one.offset), "")
    columns = (
        Column("Fit of the closed form", text=True),
        Column(f"{spoken(first.name)}{_bracketed(first.unit)}, ± 95 %"),
        *([Column(f"added to {spoken(offset)}{_bracketed(units.unit_of(offset))}, ± 95 %")]
          if offset else []),
        Column("Scatter (u)"),
    )  # fmt: skip
    lines = []
    for one in result.told:
        added = [numbers.with_u(one.offset_value, one.offset_expanded) if one.offset else "0"]
        name = f"with an offset of the {spoken(offset)}" if one.offset else "as measured"
        lines.append((name, numbers.with_u(one.value, one.expanded), *(added if offset else []),
                      numbers.plain(one.scatter, 2)))  # fmt: skip
    note = "" if any(map(matters, result.told)) or not offset else "No offset is seen."
    return Table("What the table itself says", columns, (Group("", tuple(lines)),), note)


def columns(found: TableValidation) -> Table:
    """What each column was taken for."""
    heads = (Column("Heading", text=True), Column("Taken for", text=True), Column("", text=True))
    lines = tuple(
        (one.heading, f"{one.role} {spoken(one.name)}".strip(), one.note) for one in found.columns
    )
    return Table("Columns of the table", heads, (Group("", lines),))


def _bracketed(unit: str) -> str:
    return "" if unit == "1" else f" ({'°' if unit == 'rad' else units.symbol(unit)})"
