"""Pictures of a table of results: what was measured over what was set, and what is left."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from simcompare import units
from simcompare.model.trajectory import Array
from simcompare.reports.render.figures import Band, Figure, Panel, Series
from simcompare.reports.render.styles import MEASURED_STYLE, TRUTH_STYLE, style_of
from simcompare.reports.tabled.words import capital, spoken
from simcompare.results.records.tabled import CLOSED_FORM, TabledResult, TableValidation


def figures_of(found: TableValidation) -> list[Figure]:
    """One for each result: the values, and beside them the residuals."""
    return [_figure(result) for result in found.results]


def _figure(result: TabledResult) -> Figure:
    caption = (
        "Left: every experiment with bars of 2 u, and what the sources give. Right: measured less"
        " simulated, in units of u; the band is 2 u wide on both sides."
    )
    over = spoken(result.over)
    return Figure(
        f"table-{result.name}", f"{capital(spoken(result.name))} over {over}", caption,
        (_values(result), _residuals(result)),
    )  # fmt: skip


def _values(result: TabledResult) -> Panel:
    x, order = _places(result)
    points = [result.points[i] for i in order]
    series = []
    for one in result.verdicts:
        y = np.array([_number(point.values.get(one.source)) for point in points])
        if np.isfinite(y).any():
            series.append(_series(result, one.source, x, y))
    measured = np.array([point.measured for point in points])
    bars = np.array([2 * point.u for point in points])
    series.append(Series("measured ± 2 u", x, measured, MEASURED_STYLE, bars, True, False))
    title = capital(spoken(result.name))
    return Panel(title, _label(result.over, units.unit_of(result.over)),
                 _label(result.name, result.unit), tuple(series))  # fmt: skip


def _series(result: TabledResult, source: str, x: Array, y: Array) -> Series:
    if source == CLOSED_FORM and result.curve:
        drawn = np.array(result.curve)
        return Series(source, _scale(result) * drawn[:, 0], drawn[:, 1], TRUTH_STYLE)
    if source == CLOSED_FORM:
        return Series(source, x, y, replace(TRUTH_STYLE, hollow=True), points=True, line=False)
    return Series(source, x, y, style_of(source), points=True, line=False)


def _residuals(result: TabledResult) -> Panel:
    x, order = _places(result)
    points = [result.points[i] for i in order]
    width = float(np.ptp(x)) or 1.0
    series = []
    engines = [one.source for one in result.verdicts if one.source != CLOSED_FORM]
    for number, source in enumerate(engines or [CLOSED_FORM]):
        y = np.array([_number(point.residual(source)) for point in points])
        if np.isfinite(y).any():
            # side by side, for most engines say the same
            beside = (number - (len(engines) - 1) / 2) * 0.012 * width
            series.append(Series(source, x + beside, y, style_of(source) if engines
                                 else TRUTH_STYLE, points=True, line=False))  # fmt: skip
    return Panel(
        "Residuals", _label(result.over, units.unit_of(result.over)),
        "Measured − simulated (u)", tuple(series), (Band(-2.0, 2.0, "2 u", 0.0),),
    )  # fmt: skip


def _places(result: TabledResult) -> tuple[Array, list[int]]:
    """What was set, growing, and the order of the points in which it grows."""
    x = np.array([_scale(result) * one.set.get(result.over, math.nan) for one in result.points])
    order = np.argsort(x, kind="stable")
    return x[order], order.tolist()


def _scale(result: TabledResult) -> float:
    """Angles are drawn in degrees."""
    return 180 / math.pi if units.unit_of(result.over) == "rad" else 1.0


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _label(name: str, unit: str) -> str:
    symbol = "°" if unit == "rad" else units.symbol(unit)
    return capital(spoken(name)) + ("" if unit == "1" else f" ({symbol})")
