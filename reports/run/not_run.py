"""What did not run, and why."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.run import runs
from simcompare.reports.run.listing import grouped
from simcompare.results.run import Run

_COLUMNS = tuple(Column(head, text=True) for head in ("Did not run", "Mode", "Status", "Reason"))


@dataclass(frozen=True)
class NotRun:
    """A source that did not run, at the levels at which one reason kept it.

    Attributes:
        name: of the source.
        modes: the levels, in words.
        status: what became of it.
        reason: why.
    """

    name: str
    modes: str
    status: str
    reason: str


def not_run(run: Run) -> list[NotRun]:
    """Everything that did not run, one row for one reason."""
    sources = [source for source in run.record.sources if not source.ran]
    rows = grouped(
        ((s.name, s.status, s.reason or "no reason is known"), runs.mode_words(s.contact))
        for s in sources
    )
    return [
        NotRun(name, ", ".join(modes), status, reason.removeprefix(f"{name}: "))
        for (name, status, reason), modes in rows.items()
    ]


def tables(run: Run) -> tuple[Table, ...]:
    """The same as a table; none where everything ran."""
    rows = tuple((row.name, row.modes, row.status, row.reason) for row in not_run(run))
    return (Table("", _COLUMNS, (Group("", rows),)),) if rows else ()
