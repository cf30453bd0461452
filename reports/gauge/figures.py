"""Worked examples, recomputed, as a picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare.gauging.check import Check
from simcompare.gauging.gauge import Outcome
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.styles import Style

#: how the numbers of each verdict look
_STYLES = {
    "PASS": Style("#0072B2"),
    "NOTE": Style("#E69F00", marker="square"),
    "DIFF": Style("#D55E00", marker="x"),
}
#: rows that a figure of usual height holds
_ROWS = 9


def digits(outcomes: Sequence[Outcome]) -> Figure:
    """Digits that agree, a row for each example."""
    shown = [one for one in outcomes if one.checks]
    series = [
        Series(verdict, *_places(shown, verdict), style, points=True, line=False)
        for verdict, style in _STYLES.items()
    ]
    panel = Panel(
        "", "significant digits that agree with the reference", "",
        tuple(one for one in series if len(one.x)), y_ticks=tuple(one.name for one in shown),
    )  # fmt: skip
    return Figure(
        "digits", "How many digits of the references are met",
        "Each point is one reference number. No point lies beyond the digits that are given.",
        (panel,), height=max(0.5, len(shown) / _ROWS),
    )  # fmt: skip


def _places(shown: Sequence[Outcome], verdict: str) -> tuple[np.ndarray, np.ndarray]:
    """Digits and rows of all numbers with a verdict."""
    found: list[tuple[Check, int]] = [
        (check, row)
        for row, one in enumerate(shown)
        for check in one.checks
        if check.verdict == verdict
    ]
    return (
        np.array([check.digits for check, _ in found], dtype=float),
        np.array([row for _, row in found], dtype=float),
    )
