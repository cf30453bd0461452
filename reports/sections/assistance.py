"""What each of our helps changes: the result with it, and without it."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.comparison.ablation import Ablated, Ablation
from simcompare.engine.helps import HELPS
from simcompare.reports.render import numbers
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.run import runs
from simcompare.reports.run.lead import lead_of
from simcompare.results.run import Run
from simcompare.running.jobs import OK

_SHORT = (
    Column("Help", text=True, nowrap=True),
    Column("What it does", text=True, spare=True),
    Column("Acts in", text=True),
    Column("Changes most", text=True),
    Column("With"),
    Column("Without"),
    Column("Truth"),
    Column("Tolerances"),
)
_COLUMNS = (
    Column("Engine", text=True),
    Column("Measure", text=True),
    Column("With"),
    Column("Without"),
    Column("Truth"),
)
_NOTE = (
    "The nominal repeat alone, without one help at a time, all others kept. Of each help the change"
    " that is largest in tolerances."
)
#: measures of the leading kind that are shown of each help
_SHOWN = 4
#: changes below this part of a tolerance are none
_NOTHING = 1e-6

Change = tuple[float, str, Ablated]


def assistance(run: Run) -> Part | None:
    """Every help that acted, with the nominal repeat that left it out; ``None`` where none did.

    The largest change by each help, and all of them folded.
    """
    left_out = runs.run_record(run).without
    if not left_out:
        return None
    rows = tuple(
        _short(run, name, items)
        for name in HELPS
        if (items := [item for item in left_out if item.help == name])
    )
    short = Table("", _SHORT, (Group("", rows),), _NOTE)
    tables = (short, _every(run, left_out))
    return Part("What our helps change", "helps", tables=tables, folded=True, finding=_finding(run))


def _finding(run: Run) -> str:
    """The help that changes most, and what it changes."""
    share, source, row = _largest(run, (left_out := runs.run_record(run).without))
    if row is None or share <= _NOTHING:
        return "nothing that is judged"
    help_ = next(item.help for item in left_out if item.source == source and row in item.measures)
    return f"{help_} changes {runs.measure_words(row.measure)} most, in {source}"


def _short(run: Run, name: str, items: Sequence[Ablation]) -> tuple[str, ...]:
    """One row for a help: in how many engines it acts, and the largest change that it makes."""
    head = (name, HELPS[name])
    ran = len({item.source for item in items if item.status == OK})
    acts = f"{ran} engine{'' if ran == 1 else 's'}"
    share, source, row = _largest(run, items)
    if row is None or share <= _NOTHING:
        return *head, acts, "nothing that is judged", "–", "–", "–", "0"
    what = f"{runs.label(row.measure, row.unit)} in {source}"
    values = (numbers.plain(value, 5) for value in _values(row))
    return *head, acts, what, *values, numbers.plain(share, 2)


def _largest(run: Run, items: Sequence[Ablation]) -> tuple[float, str, Ablated | None]:
    """The largest change in tolerances: of the leading measure if it changes, else of any."""
    lead = lead_of(run)
    changes: list[Change] = [
        (share, item.source, row)
        for item in items
        if item.status == OK
        for row in item.measures
        if (share := _share(run, item.source, row)) is not None
    ]
    leading = [c for c in changes if lead and c[2].measure == lead.measure and c[0] > _LEADS]
    return max(leading or changes, key=lambda change: change[0], default=(0.0, "", None))


#: a change of the leading measure by this part of its tolerance is told before any other
_LEADS = 0.1


def _share(run: Run, source: str, row: Ablated) -> float | None:
    tolerance = runs.tolerances(run, source).get(row.measure)
    if tolerance is None or row.with_ is None or row.without is None or row.truth is None:
        return None
    return abs(row.with_ - row.without) / tolerance.width(row.truth)


def _values(row: Ablated) -> tuple[float | None, ...]:
    return row.with_, row.without, row.truth


def _every(run: Run, left_out: Sequence[Ablation]) -> Table:
    """One group of rows for each help."""
    lead = runs.measures(run)[:_SHOWN]
    groups = []
    for name in HELPS:
        rows: list[tuple[str, ...]] = []
        for item in (item for item in left_out if item.help == name):
            if item.status != OK:
                rows.append((item.source, item.reason or item.status, "", "–", ""))
                continue
            shown = {row.measure: row for row in item.measures}
            rows += [
                (
                    item.source,
                    runs.label(measure, shown[measure].unit),
                    *map(numbers.plain, _values(shown[measure])),
                )
                for measure in lead
                if measure in shown
            ]
        if rows:
            groups.append(Group(f"{name}: {HELPS[name]}", tuple(rows)))
    return Table("Engine by engine", _COLUMNS, tuple(groups), folded=True)
