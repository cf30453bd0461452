"""Which numbers stand for a restitution in each engine, and what bounces with them do."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.model.settings import ASSISTED
from simcompare.model.tuning import TuningRow
from simcompare.reports.render import numbers
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, of_engines
from simcompare.reports.run.tuning_phrases import numbers_typed
from simcompare.results.records.run import SourceRecord
from simcompare.results.run import Run

_COLUMNS = (
    Column("Impact at (m/s)"),
    Column("Restitution ± s"),
    Column("Off by (%)"),
    Column("Depth (mm)"),
    Column("Contact (ms)"),
    Column("Next impact late by (ms)"),
    Column("", text=True),
)
#: at the drop whose restitution was solved for, nothing is judged
CALIBRATED = "calibrated"


_NOTE = (
    "Each row is the mean over 25 drops that fall at even phases of the step, and after ± their"
    " standard deviation, by which single drops differ. The numbers were solved for the first speed"
    f" alone, so that row reads “{CALIBRATED}”; all others are what the engine then does, also from"
    " half and from double the height. Restitution is speed after over speed before, both at the"
    " floor; how long a contact lasts stands beside."
)


def tuning(run: Run) -> Part | None:
    """The numbers of ``tuned``, and the drops that they were found on; ``None`` without any."""
    sources = [s for s in run.record.sources if s.contact != ASSISTED and s.tuning]
    groups = [
        Group(_title(source, row), _rows(source.name, row))
        for source in sources
        for row in source.tuning
    ]
    table = of_engines(_COLUMNS, groups, _NOTE)
    if not groups:
        return None
    finding = _finding([row for source in sources for row in source.tuning])
    return Part("How the bounce was tuned", "tuning", tables=(table,), folded=True, finding=finding)


def _finding(rows: Sequence[TuningRow]) -> str:
    """How far bounces are off at speeds for which nothing was solved."""
    off = [
        abs(at.restitution / row.restitution - 1)
        for row in rows
        for at in (*row.at[1:], *row.checks)
    ]
    if not off:
        return "at the speed of the first impact"
    return f"at the first impact; at other speeds off by up to {numbers.percent(max(off))}"


def _title(source: SourceRecord, row: TuningRow) -> str:
    pairs = ", ".join("-".join(pair) for pair in row.pairs)
    title = (
        f"{source.name}: {numbers_typed(source, row)} for {numbers.plain(row.restitution)}"
        f" between {pairs}, at a step of {numbers.plain(1e3 * row.step_s)} ms"
    )
    if row.stall_speed_m_s:
        title += f"; hops of {numbers.plain(row.stall_speed_m_s, 2)} m/s never die out"
    return title


def _rows(engine: str, row: TuningRow) -> tuple[tuple[str, ...], ...]:
    rows = []
    marked = [(at, f"impact {i}") for i, at in enumerate(row.at, start=1)]
    marked[:1] = [(at, f"{words}: {CALIBRATED}") for at, words in marked[:1]]
    marked += zip(row.checks, ("half height", "double height"), strict=False)
    for at, words in marked:
        value, wanted = at.restitution, row.restitution
        rows.append(
            (
                engine,
                numbers.plain(at.speed_m_s, 3),
                numbers.with_u(value, at.scatter),
                numbers.plain(100 * (value / wanted - 1), 2),
                _thousandfold(at.penetration_m),
                _thousandfold(at.contact_s),
                _thousandfold(at.delay_s),
                words,
            )
        )
    return tuple(rows)


def _thousandfold(value: float) -> str:
    return numbers.plain(1e3 * value, 3)
