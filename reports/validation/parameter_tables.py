"""Tables of a validation's parameters: what was known, what was fitted, and to which segment."""

from __future__ import annotations

import math
from collections.abc import Sequence

from simcompare import units
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Scale, Table, scale_of
from simcompare.reports.validation import phrases, validations
from simcompare.results.records.validation import ParameterRecord
from simcompare.results.run import Run


def parameters(run: Run, *, chosen: bool = False) -> Table | None:
    """What was known, what was fitted, and where each number comes from.

    Args:
        run: the validation.
        chosen: without those that were left as the scenario has them.
    """
    every = validations.validation(run).parameters
    rows = [row for row in every if not chosen or row.kind != "scenario"]
    if not rows:
        return None
    columns = [Column("Parameter", text=True, nowrap=True), Column("Unit", text=True, nowrap=True),
               Column("Known before ± u")]  # fmt: skip
    columns += [Column("Fitted ± u")] if validations.is_fitted(run) else []
    columns += [Column("From", text=True, spare=True)]
    return Table("", tuple(columns), (Group("", tuple(_parameter(run, row) for row in rows)),))


def _parameter(run: Run, row: ParameterRecord) -> tuple[str, ...]:
    before = numbers.with_u(row.known, row.u_known or None)
    if row.known is None and row.kind == "read off":
        before = "each segment its own"
    cells = [phrases.parameter(row.name), "" if row.unit == "1" else row.unit, before]
    if validations.is_fitted(run):
        cells.append("" if row.fitted is None else numbers.with_u(row.fitted, row.u_fitted))
    return (*cells, row.source)


def single_fits(run: Run) -> Table | None:
    """What each segment gives when it is fitted alone."""
    fit = validations.validation(run).fit
    if fit is None or not fit.single:
        return None
    known = {row.name: row.u_fitted for row in validations.validation(run).parameters}
    u = [known.get(name) for name in fit.names]
    scales = [
        _scale_beside(column, one)
        for column, one in zip(zip(*fit.single.values(), strict=True), u, strict=True)
    ]
    heads = [
        phrases.parameter(name) + scale.unit(units.symbol(units.unit_of(name)))
        for name, scale in zip(fit.names, scales, strict=True)
    ]
    rows = [
        (validations.short(stream), *(s.text(v) for s, v in zip(scales, values, strict=True)))
        for stream, values in fit.single.items()
    ]
    rows.append(("u of all together", *(s.text(v) for s, v in zip(scales, u, strict=True))))
    columns = (Column("Segment", text=True, nowrap=True), *map(Column, heads))
    return Table("Each segment fitted alone", columns, (Group("", tuple(rows)),))


def _scale_beside(values: Sequence[float], u: float | None) -> Scale:
    """The scale on which values have two digits of the uncertainty beside them."""
    scale = scale_of(values, 4)
    if not u:
        return scale
    places = 1 - math.floor(math.log10(u)) + scale.power
    return Scale(scale.power, min(max(places, 0), 9))
