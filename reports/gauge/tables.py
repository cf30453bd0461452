"""Published examples, recomputed, as one table."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal

from simcompare import notation
from simcompare.gauging.check import Check
from simcompare.gauging.gauge import Outcome
from simcompare.reports.render.tables import Column, Group, Table

_COLUMNS = (
    Column("Quantity", text=True),
    Column("Published"),
    Column("Computed"),
    Column("Digits"),
    Column("Verdict", text=True, nowrap=True),
)
#: digits of the computed number beyond those that are published
_MORE = 2


def of(outcomes: Sequence[Outcome]) -> Table:
    """All numbers, a group for each example."""
    return Table("", _COLUMNS, tuple(map(_group, outcomes)))


def _group(one: Outcome) -> Group:
    rows = tuple(map(_row, one.checks)) or (("not computed", "–", "–", "–", "SKIPPED"),)
    return Group(f"{one.name}: {one.title}", rows)


def _row(check: Check) -> tuple[str, ...]:
    published = notation.minus(check.published)
    return check.quantity, published, _computed(check), f"{check.digits:.1f}", check.verdict


def _computed(check: Check) -> str:
    """The number in the form of the published one, with some more digits."""
    if "e" in check.published:
        digits = len(Decimal(check.published).as_tuple().digits) - 1
        return notation.minus(f"{check.computed:.{digits + _MORE}e}")
    exponent = Decimal(check.published).as_tuple().exponent
    assert isinstance(exponent, int)
    return notation.fixed(check.computed, _MORE - exponent)
