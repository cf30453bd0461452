"""Engines held against measured bounces: E_n numbers, and whether a value lies in a stated band."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from simcompare.comparison.comparison import Score
from simcompare.hardware.recordings.bounce_table import BounceTable, Quantity
from simcompare.statistics.agreement import COVERAGE_FACTOR, COVERAGE_PROBABILITY, e_n
from simcompare.statistics.budget import coverage_factor


@dataclass(frozen=True)
class Match:
    """One simulated value beside the measured one.

    Attributes:
        source: name of the engine.
        contact: its contact level.
        quantity: what was measured.
        bounce: number of the bounce.
        value: simulated value, mean over the repeats; ``None`` where the engine has no such bounce.
        scatter: its standard deviation over the repeats: a measured drop is one of them.
        measured: measured value.
        u_measured: its standard uncertainty, ``None`` where none is known.
        low: lower stated limit.
        high: upper stated limit.
        unit: unit of all of these.
        e_n: E_n number (ISO 13528:2022, 9.7): deviation over the root sum of squares of both
            expanded uncertainties, k = 2, larger for the scatter of few repeats; ``None`` without
            an uncertainty, and for limits.
        inside: whether the value is within the stated limits, or |E_n| ≤ 1 where there are none;
            ``None`` where it cannot be told.
    """

    source: str
    contact: str
    quantity: str
    bounce: int
    value: float | None
    scatter: float | None
    measured: float
    u_measured: float | None
    low: float | None
    high: float | None
    unit: str
    e_n: float | None
    inside: bool | None


def matches(table: BounceTable, scores: Iterable[Score], units: dict[str, str]) -> list[Match]:
    """Every measured value beside every source's.

    Args:
        table: what was measured.
        scores: the per-bounce scores of all sources.
        units: unit of every quantity.
    """
    rows = list(scores)
    sources = list(dict.fromkeys((score.source, score.contact) for score in rows))
    by_key = {(s.source, s.contact, s.measure, s.index): s for s in rows if s.index is not None}
    return [
        _match(quantity, source, by_key.get((*source, quantity.name, quantity.bounce)), units)
        for source in sources
        for quantity in table.quantities
    ]


def _match(
    quantity: Quantity, source: tuple[str, str], score: Score | None, units: dict[str, str]
) -> Match:
    value, scatter = (score.value, score.scatter) if score is not None else (None, None)
    found = None
    if value is not None and quantity.u is not None and quantity.low is None:
        found = e_n(value, quantity.value, _expanded(score), COVERAGE_FACTOR * quantity.u)
    return Match(
        *source, quantity.name, quantity.bounce, value, scatter, quantity.value, quantity.u,
        quantity.low, quantity.high, units[quantity.name], found, _inside(quantity, value, found),
    )  # fmt: skip


def _expanded(score: Score | None) -> float:
    """U of a source: so few repeats tell their scatter (JCGM 100:2008, G.3)."""
    if score is None or not score.scatter:
        return 0.0
    return coverage_factor(score.repeats - 1, COVERAGE_PROBABILITY) * score.scatter


def _inside(quantity: Quantity, value: float | None, number: float | None) -> bool | None:
    if value is None:
        return False  # the measured bounce did not happen in the engine
    if quantity.low is not None and quantity.high is not None:
        return quantity.low <= value <= quantity.high
    return None if number is None else abs(number) <= 1
