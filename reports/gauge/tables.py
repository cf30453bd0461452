"""Worked examples, recomputed, as one table."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal

from simcompare import notation
from simcompare.gauging.check import Check
from simcompare.gauging.gauge import Outcome
from simcompare.reports.render.tables import Column, Group, Table

_COLUMNS = (
    Column("Quantity", text=True),
    Column("Reference"),
    Column("Kind", text=True, nowrap=True),
    Column("Computed"),
    Column("Digits"),
    Column("Held to", text=True, nowrap=True),
    Column("Verdict", text=True, nowrap=True),
)
#: digits of the computed number beyond those of the reference
_MORE = 2


def of(outcomes: Sequence[Outcome]) -> Table:
    """All numbers, a group for each example."""
    return Table("", _COLUMNS, tuple(map(_group, outcomes)))


def _group(one: Outcome) -> Group:
    nothing = ("not computed", "–", "–", "–", "–", "–", "SKIPPED")
    return Group(f"{one.name}: {one.title}", tuple(map(_row, one.checks)) or (nothing,))


def _row(check: Check) -> tuple[str, ...]:
    reference = notation.minus(check.reference)
    return (
        check.quantity, reference, check.kind, _computed(check), f"{check.digits:.1f}",
        check.held_to, check.verdict,
    )  # fmt: skip


def _computed(check: Check) -> str:
    """With its standard error, or in the form of the reference with some more digits."""
    if check.standard_error:
        return notation.number(check.computed, check.standard_error)
    if "e" in check.reference:
        digits = len(Decimal(check.reference).as_tuple().digits) - 1
        return notation.minus(f"{check.computed:.{digits + _MORE}e}")
    exponent = Decimal(check.reference).as_tuple().exponent
    assert isinstance(exponent, int)
    return notation.fixed(check.computed, _MORE - exponent)
