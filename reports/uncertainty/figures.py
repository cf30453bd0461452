"""The picture of ``uncertainty``: which input matters, and how the result is distributed."""

from __future__ import annotations

import numpy as np

from simcompare import units
from simcompare.propagation.propagated import Propagated
from simcompare.reports.render.figures import Bars, Figure, Note, Panel, Series
from simcompare.reports.render.styles import Style
from simcompare.reports.uncertainty import tables
from simcompare.reports.uncertainty.answer import words
from simcompare.results.records.uncertainty import Uncertainty, Way
from simcompare.statistics.budget import Budget
from simcompare.statistics.monte_carlo import MonteCarlo

_SHARES = "#0072B2"
_TRIALS = Style("#56B4E9", width=2.0)
_FIRST = Style("#D55E00", "dash", "square")
_SYMMETRIC = Style("#009E73", "solid", "circle")
_SHORTEST = Style("#CC79A7", "dot", "diamond")
#: of the axis of shares, so that their numbers stand beside the bars
_ROOM = 1.25
#: most inputs that are drawn, the largest
_MOST = 10


def figure_of(result: Uncertainty, number: int = 0) -> Figure | None:
    """Shares of the inputs beside the distribution; ``None`` where nothing is uncertain."""
    if not result.known:
        return None
    way, found = result.known[number]
    if not found.budget.u and found.monte_carlo is None:
        return None
    panels = [_shares(found.budget)] if found.budget.u else []
    panels.append(_distribution(result, found))
    return Figure(
        f"uncertainty-{way.source}".replace(" ", "_"),
        f"What leaves the {words(result.of) or 'result'} open{_by(result, way)}",
        _caption(found),
        tuple(panels),
    )


def _by(result: Uncertainty, way: Way) -> str:
    return f", {way.source}" if len(result.known) > 1 else ""


def _caption(found: Propagated) -> str:
    shares = "Left: share of each input in the variance, to first order. " if found.budget.u else ""
    side = "Right" if shares else "Here"
    if found.monte_carlo is None:
        return f"{shares}{side}: the distribution that first order says, and its interval."
    return (
        f"{shares}{side}: the trials of Monte Carlo as a histogram, with what first order says"
        " and three intervals of the same probability."
    )


def _shares(budget: Budget) -> Panel:
    rows = budget.largest_first[:_MOST]
    heights = np.array([max(0.0, 100 * row.share) for row in rows])
    bars = (Bars("share", heights, _SHARES),)
    names = tuple(row.name for row in rows)
    notes = tuple(
        Note(float(height), i, f" {tables.share_of(row)}")
        for i, (row, height) in enumerate(zip(rows, heights, strict=True))
    )
    limits = (0.0, _ROOM * max(100.0, float(heights.max())))
    return Panel(
        "Share of the variance", "share (%)", "", (), bars=bars, y_ticks=names, x_limits=limits,
        notes=notes,
    )  # fmt: skip


def _distribution(result: Uncertainty, found: Propagated) -> Panel:
    budget, trials = found.budget, found.monte_carlo
    series: list[Series] = []
    if trials is not None and trials.density:
        series.append(_histogram(trials))
    if budget.u:
        series.append(_of_first_order(budget))
    top = max((float(row.y.max()) for row in series), default=1.0)
    percent = f"{100 * budget.probability:g} %"
    ends = {f"first order ± U ({percent})": (budget.interval, _FIRST)} if budget.u else {}
    if trials is not None:
        ends[f"symmetric ({percent})"] = (trials.symmetric, _SYMMETRIC)
        ends[f"shortest ({percent})"] = (trials.shortest, _SHORTEST)
    for i, (label, (interval, style)) in enumerate(ends.items()):
        height = np.full(2, top * (1.08 + 0.09 * i))
        series.append(Series(label, np.array(interval), height, style, points=True))
    unit = "" if result.unit == "1" else f" ({units.symbol(result.unit)})"
    quantity = f"{words(result.of) or 'result'}{unit}"
    limits = (0.0, top * (1.16 + 0.09 * len(ends)))
    return Panel(
        "Distribution", quantity, "probability density", tuple(series), y_range=limits, weight=1.4
    )


def _histogram(trials: MonteCarlo) -> Series:
    """Bars as one line: up, along and down again."""
    edges, density = np.array(trials.edges), np.array(trials.density)
    x = np.repeat(edges, 2)
    y = np.concatenate([[0.0], np.repeat(density, 2), [0.0]])
    return Series("Monte Carlo", x, y, _TRIALS)


def _of_first_order(budget: Budget) -> Series:
    from scipy import stats

    x = budget.estimate + budget.u * np.linspace(-3.5, 3.5, 141)
    y = stats.t.pdf((x - budget.estimate) / budget.u, budget.degrees_of_freedom) / budget.u
    return Series("first order", x, np.asarray(y, dtype=float), _FIRST)
