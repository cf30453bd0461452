"""Tables of ``uncertainty``: the budget, and all ways to the result."""

from __future__ import annotations

from simcompare import units
from simcompare.propagation.propagated import Propagated
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.uncertainty.answer import beside, count_of
from simcompare.results.records.uncertainty import CLOSED_FORM, Uncertainty, Way
from simcompare.statistics.budget import Row
from simcompare.statistics.monte_carlo import MonteCarlo

#: words under the budget that need one
BUDGET_WORDS = ("sensitivity", "contribution", "share", "degrees of freedom")
WAYS_WORDS = ("U", "first order", "Monte Carlo", "shortest")
#: shares that are not worth their digits, and those that are rounding
_SMALL, _ROUNDING = 1e-4, 1e-20
_SHAPES = {"u_shaped": "U-shaped", "truncated_normal": "truncated normal", "student_t": "t"}


def budget_of(result: Uncertainty, number: int = 0) -> Table:
    """The budget of one of the ways, what matters most first."""
    way, found = result.known[number]
    stated = {one.name: one for one in result.inputs}
    unit = _bracketed(result.unit)
    columns = (
        Column("Input", text=True, nowrap=True),
        Column("Estimate"),
        Column("Stated", text=True, nowrap=True),
        Column("u"),
        Column("Distribution", text=True),
        Column("Degrees of freedom"),
        Column("Sensitivity"),
        Column(f"Contribution{unit}"),
        Column("Share"),
    )
    rows = tuple(
        _row(row, stated[row.name].stated if row.name in stated else "scatter of repeats",
             stated[row.name].unit if row.name in stated else result.unit)
        for row in found.budget.largest_first
    )  # fmt: skip
    budget = found.budget
    whole = (
        "combined", numbers.plain(budget.estimate), "", _two(budget.u), "",
        count_of(budget.degrees_of_freedom), "", _two(budget.u), "100 %",
    )  # fmt: skip
    title = f"Budget of first order, {way.source}"
    return Table(title, columns, (Group("", (*rows, whole)),))


def _row(row: Row, stated: str, unit: str) -> tuple[str, ...]:
    symbol = "" if unit == "1" else f"\u00a0{units.symbol(unit)}"
    return (
        row.name, f"{numbers.plain(row.estimate)}{symbol}", stated,
        _two(row.u), _SHAPES.get(row.distribution, row.distribution),
        count_of(row.degrees_of_freedom), *_effect(row),
    )  # fmt: skip


def _effect(row: Row) -> tuple[str, str, str]:
    """Sensitivity, contribution and share; what rounding alone makes is nothing."""
    if abs(row.share) < _ROUNDING:
        return "0", "0", "0 %"
    return numbers.plain(row.sensitivity, 3), _two(row.contribution), share_of(row)


def _two(u: float) -> str:
    """An uncertainty in two digits, the second also where it is 0."""
    mantissa, dot, power = numbers.plain(u, 2).partition("·")
    if len(mantissa.replace(".", "").lstrip("0")) == 1:
        mantissa += "0" if "." in mantissa else ".0"
    return f"{mantissa}{dot}{power}"


def share_of(row: Row) -> str:
    """The part of the variance that an input makes, in per cent."""
    if abs(row.share) < _ROUNDING:
        return "0 %"
    return "< 0.01 %" if abs(row.share) < _SMALL else numbers.percent(row.share)


def ways_of(result: Uncertainty) -> Table:
    """Every way to the result with its U and both intervals of Monte Carlo."""
    unit = _bracketed(result.unit)
    columns = (
        Column("By", text=True, nowrap=True),
        Column(f"Value{unit}"),
        Column("Off the closed form"),
        Column("U"),
        Column("k"),
        Column("Degrees of freedom"),
        Column("symmetric", text=True, over="Monte Carlo"),
        Column("shortest", text=True, over="Monte Carlo"),
        Column("trials", over="Monte Carlo"),
        Column("First order", text=True),
    )
    first = next(iter(result.known), None)
    true = None
    if first is not None and first[0].source == CLOSED_FORM:
        true = first[1].budget.estimate
    known = [_way(way, found, true) for way, found in result.known]
    missing = [(way.source, *["–"] * 8, way.status) for way in result.ways if way.found is None]
    made = Table("", columns, (Group("", (*known, *missing)),))
    return (
        made if true is not None and len(result.ways) > 1 else made.without(["Off the closed form"])
    )


def _way(way: Way, found: Propagated, true: float | None) -> tuple[str, ...]:
    budget, trials, checked = found.budget, found.monte_carlo, found.validation
    value, expanded = beside(budget.estimate, budget.expanded)
    name = f"{way.source}, {way.contact}" if way.contact else way.source
    verdict = "–" if checked is None else "enough" if checked.passed else "not enough"
    return (
        name, value, _difference(way, budget.estimate, true), expanded, f"{budget.k:.2f}",
        count_of(budget.degrees_of_freedom), *_intervals(trials), verdict,
    )  # fmt: skip


def _difference(way: Way, value: float, true: float | None) -> str:
    if true is None or way.source == CLOSED_FORM:
        return "–"
    off = value - true
    return "0" if abs(off) <= numbers.ROUNDING * abs(true) else numbers.plain(off, 2)


def _intervals(trials: MonteCarlo | None) -> tuple[str, str, str]:
    if trials is None:
        return "–", "–", "–"
    width = (trials.symmetric[1] - trials.symmetric[0]) / 2
    return (
        "\u00a0…\u00a0".join(beside(end, width)[0] for end in trials.symmetric),
        "\u00a0…\u00a0".join(beside(end, width)[0] for end in trials.shortest),
        numbers.plain(trials.trials),
    )


def _bracketed(unit: str) -> str:
    return "" if unit == "1" else f" ({units.symbol(unit)})"
