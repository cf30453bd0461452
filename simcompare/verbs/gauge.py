"""The verb ``gauge``: worked examples, recomputed and judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from simcompare.arguments import checked
from simcompare.gauging import gauge as gauging
from simcompare.gauging import registry
from simcompare.gauging.gauge import Outcome, Row
from simcompare.reports.gauge import figures, tables, words
from simcompare.reports.render import matplotlib_
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.verbs.levels import chosen_names

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Gauged(Shown):
    """What came out of the worked examples.

    Attributes:
        outcomes: one for each example.
    """

    outcomes: tuple[Outcome, ...]

    @property
    def rows(self) -> list[Row]:
        """Every number with its verdict."""
        return [row for one in self.outcomes for row in one.rows]

    @property
    def passed(self) -> bool:
        """Whether no number is off for a reason that is not named."""
        return not any(row.verdict == "DIFF" for row in self.rows)

    @property
    def exit_code(self) -> int:
        """That of the command: 1 where a number is off, 2 where files for all of them lack."""
        if all(row.verdict == "SKIPPED" for row in self.rows):
            return 2
        return 0 if self.passed else 1

    def plot(self) -> Figure:
        """Digits that agree, a row for each example."""
        return matplotlib_.canvas(figures.digits(self.outcomes))

    def _glance(self) -> Glance:
        return Glance(
            title="Worked examples with a known answer, recomputed",
            sentences=(words.answer(self.outcomes),),
            legend=tuple(words.legend()),
            table=tables.of(self.outcomes),
            notes=tuple(words.notes(self.outcomes)),
            figure=figures.digits(self.outcomes),
            more="More: .table(), .plot(), .rows",
        )


@checked
def gauge(examples: str | Sequence[str] = "all") -> Gauged:
    """Recomputes worked examples with the functions that the other verbs use.

    The answers of these examples are published, or exact: a closed form or quadrature.

    ::

        simcompare.gauge()
        simcompare.gauge("gum_h1,nist_strd").table()

    Args:
        examples: "all", names with commas or a list of names.

    Returns:
        Every reference number and the computed one, with the digits that agree and a verdict.

    Raises:
        UnknownName: no such example.
    """
    return Gauged(gauging.gauged(chosen_names("worked example", examples, registry.names())))
