"""Engines against a measurement."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from simcompare.compare.against import Match
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import style_of
from simcompare.reports.run import measurement_figures, runs
from simcompare.reports.run.listing import count_of
from simcompare.reports.sections.base import Section
from simcompare.results.run import Run

_WORDS = {
    True: ("✓", "consistent with the measurement"),
    False: ("✗", "not consistent with the measurement"),
    None: ("·", "cannot be told"),
}


class Measured(Section):
    """What was measured, and every engine beside it."""

    name, title, template = "measurement", "Against measurement", "measured.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """Figure and table of all matches; ``None`` where the run was held against nothing."""
        against = runs.own_record(run).against
        if not against or not against.matches:
            return None
        return {
            "head": against.head,
            "file": against.file,
            "caution": against.caution,
            "sentences": [_sentence(run, mode) for mode in runs.modes(run)],
            "figures": [
                measurement_figures.measured_figure(run, name)
                for name in measurement_figures.quantities(run)
            ],
            "groups": _groups(against.matches),
        }


def _groups(matches: Sequence[Match]) -> list[dict[str, Any]]:
    """One group of rows for each measured value."""
    found: dict[tuple[str, int], list[Match]] = {}
    for match in matches:
        found.setdefault((match.quantity, match.bounce), []).append(match)
    return [
        {
            "title": f"{runs.measure_words(quantity)}, event {event}"
            f"{runs.unit_words(rows[0].unit)}",
            "measured": numbers.with_u(rows[0].measured, rows[0].u_measured),
            "limits": _limits(rows[0]),
            "rows": [_row(match) for match in rows],
        }
        for (quantity, event), rows in found.items()
    ]


def _limits(match: Match) -> str | None:
    if match.low is None or match.high is None:
        return None
    return f"{numbers.plain(match.low)} … {numbers.plain(match.high)}"


def _row(match: Match) -> dict[str, Any]:
    symbol, words = _WORDS[match.inside]
    if match.value is None:
        words += ": there is no such event in the engine"
    return {
        "source": match.source,
        "style": style_of(match.source),
        "mode": runs.mode_words(match.contact),
        "value": numbers.with_u(match.value, match.scatter, scale=match.measured),
        "e_n": "–" if match.e_n is None else numbers.plain(match.e_n, 2),
        "inside": match.inside,
        "symbol": symbol,
        "words": words,
    }


def _sentence(run: Run, mode: str) -> str:
    """How many engines are consistent with every measured value."""
    by_source: dict[str, list[bool | None]] = {}
    for match in measurement_figures.matches_of(run):
        if match.contact == mode:
            by_source.setdefault(match.source, []).append(match.inside)
    good = sum(all(inside) for inside in by_source.values())
    are = "is" if good in (0, 1) or len(by_source) == 1 else "are"
    head = runs.mode_title(mode)
    subject = count_of(good, len(by_source))
    return f"{head[0].upper()}{head[1:]}: {subject} {are} consistent with the measurement."
