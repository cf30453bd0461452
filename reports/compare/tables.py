"""The table of a measure: engines and levels against runs, whichever way round fits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from simcompare.comparison.comparison import FAIL, PASS
from simcompare.notation import capital
from simcompare.reports.compare.compared import Compared
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.render.text_tables import lines
from simcompare.reports.run import lead_table, runs
from simcompare.reports.run.lead import Lead

#: behind a value that was judged, where a run has no such engine or level, and no truth
MARKS, NOT_RUN, NO_TRUTH = {PASS: " ✓", FAIL: " ✗"}, "not run", "none"
#: runs that still stand beside each other
_BESIDE = 6
_ENDLESS = 10_000

Sources = Sequence[tuple[str, str]]


def tables(compared: Compared, measure: str, width: int | None = None) -> list[Table]:
    """A measure of all runs: one table, or several where it does not fit into one.

    Args:
        compared: the runs.
        measure: what is shown.
        width: letters on a line, ``None`` where a table may be as wide as it needs.
    """
    made = runs_beside(compared, measure)
    if len(compared.runs) <= _BESIDE and _fits(made, width):
        return [made]
    return [
        table for level in compared.levels for table in _runs_below(compared, measure, level, width)
    ]


def one_table(compared: Compared, measure: str) -> Table:
    """A measure of all runs in one table, however wide; few runs stand beside each other."""
    if len(compared.runs) <= _BESIDE:
        return runs_beside(compared, measure)
    return _below(compared, compared.leads(measure), compared.sources, over=True)


def what_differs(compared: Compared) -> Table:
    """Each run with what its title does not say, and where it is stored."""
    rest = compared.untold
    columns = [
        Column(head, text=True) for head in ("run", *(one.head for one in rest), "made", "folder")
    ]
    rows = tuple(
        (title, *(one.number(i) for one in rest), run.record.created[:16].replace("T", " "), place)
        for i, (title, run) in enumerate(zip(compared.titles, compared.runs, strict=True))
        for place in [str(run.folder or "not stored")]
    )
    return Table("", tuple(columns), (Group("", rows),))


def runs_beside(compared: Compared, measure: str) -> Table:
    """Engines as rows, level by level; runs as columns."""
    leads = compared.leads(measure)
    columns = [
        Column("engine", text=True),
        *(Column(title, text=True) for title in compared.titles),
    ]
    groups = [
        Group(
            capital(runs.mode_words(level)),
            tuple(
                (name, *_cells(compared, leads, name, level))
                for name, at in compared.sources
                if at == level
            ),
        )
        for level in compared.levels
    ]
    if true := tuple(_truth_rows(leads)):
        groups.append(Group("Truth", true))
    return Table(_title(compared, leads), tuple(columns), tuple(groups))


def _runs_below(compared: Compared, measure: str, level: str, width: int | None) -> Iterator[Table]:
    """Runs as rows, the engines of a level as columns, as many as fit beside each other."""
    leads = compared.leads(measure)
    sources = [one for one in compared.sources if one[1] == level]
    while sources:
        count = len(sources)
        while count > 1 and not _fits(_below(compared, leads, sources[:count]), width):
            count -= 1
        yield _below(compared, leads, sources[:count])
        sources = sources[count:]


def _below(
    compared: Compared, leads: Sequence[Lead], sources: Sources, *, over: bool = False
) -> Table:
    """Runs as rows, engines as columns; ``over`` them stands their level where it is wanted."""
    told = compared.told
    columns = [Column(one.head, text=not one.numeric) for one in told] or [Column("run", text=True)]
    columns += [
        Column(name, text=True, over=runs.mode_words(level) if over else "")
        for name, level in sources
    ]
    truths = list(map(_accepted, leads))
    same = len(set(truths)) == 1
    if not same:
        columns.insert(max(len(told), 1), Column("truth", text=True))
    rows = []
    for i, title in enumerate(compared.titles):
        keys = [one.number(i) for one in told] or [title]
        cells = [_cell(compared, leads, i, name, level) for name, level in sources]
        rows.append((*keys, *(() if same else (truths[i],)), *cells))
    level = "" if over else runs.mode_words(sources[0][1])
    title = _title(compared, leads, level) + (
        f"; truth {truths[0]}" if same and leads[0].truth is not None else ""
    )
    return Table(title, tuple(columns), (Group("", tuple(rows)),))


def _fits(table: Table, width: int | None) -> bool:
    return width is None or max(map(len, lines(table, _ENDLESS))) <= width


def _cells(compared: Compared, leads: Sequence[Lead], name: str, level: str) -> list[str]:
    return [_cell(compared, leads, i, name, level) for i in range(len(compared.runs))]


def _cell(compared: Compared, leads: Sequence[Lead], number: int, name: str, level: str) -> str:
    run = compared.runs[number]
    if runs.source_of(run, name, level) is None:
        return NOT_RUN
    return lead_table.cell(run, leads[number], name, level, MARKS)


def _truth_rows(leads: Sequence[Lead]) -> Iterator[tuple[str, ...]]:
    """The truth of each run, and its tolerance."""
    if any(lead.truth is not None for lead in leads):
        yield ("value", *(_truth(lead) for lead in leads))
    if any(lead.width is not None for lead in leads):
        yield ("tolerance", *(f"± {lead.accepted}" if lead.widths else NO_TRUTH for lead in leads))


def _accepted(lead: Lead) -> str:
    """The truth with its tolerance."""
    return f"{_truth(lead)} ± {lead.accepted}" if lead.widths else _truth(lead)


def _truth(lead: Lead) -> str:
    return NO_TRUTH if lead.truth is None else lead_table.number(lead, lead.truth, None)


def _title(compared: Compared, leads: Sequence[Lead], level: str = "") -> str:
    lead, at = leads[0], f", {level}" if level else ""
    unit = "" if lead.unit in ("", "1") else f" in {lead.unit}"
    mean = lead_table.mean_words(lead, [run.record.repeats for run in compared.runs])
    return f"{capital(lead.words)}{unit}{at}{mean}"
