"""What each engine was really given: the audit, and the rule by which it was translated."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.model.audit import AuditRow
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.reports.render import numbers
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.run import runs
from simcompare.reports.run.audit import SAME, TRANSLATED, UNREAD, UNSET, state_of
from simcompare.results.records.run import SourceRecord
from simcompare.results.run import Run

_WORDS = {
    SAME: "",
    UNSET: "≠ engine's own value",
    TRANSLATED: "⇄ translated",
    UNREAD: "? cannot be read back",
}
_QUANTITY = (
    Column("Quantity", text=True), Column("Scenario"), Column("Engine's parameter", text=True),
)  # fmt: skip
_COLUMNS = (
    *_QUANTITY, Column("Set"), Column("Held"), Column("Unit", text=True, nowrap=True),
    Column("", text=True, nowrap=True), Column("Note", text=True),
)  # fmt: skip
_UNSET_COLUMNS = (
    Column("Engine", text=True), Column("Mode", text=True, nowrap=True), *_QUANTITY, Column("Held"),
    Column("Unit", text=True, nowrap=True), Column("Note", text=True),
)  # fmt: skip
_NOTE = (
    "Every value that an engine was given, read back from it; a note says where an engine cannot"
    " tell. “Translated” means that the mapping rule set this value so that the engine behaves as"
    " the scenario asks."
)


def given(run: Run) -> Part:
    """What differs in the engines' defaults, and one table for each engine and mode."""
    parts = tuple(map(_source, run.record.sources))
    unset = _unset(run)
    return Part("What each engine was given", "given", notes=(_NOTE,),
                tables=(unset,) if unset else (), parts=parts, folded=True, finding=_finding(run),
                brief=False)  # fmt: skip


def _finding(run: Run) -> str:
    """How many values were read back, and how many of them are the engine's own."""
    states = [state_of(row) for source in run.record.sources for row in source.audit]
    return f"{len(states)} values, {states.count(UNSET)} of them the engine's own"


def _unset(run: Run) -> Table | None:
    """Where engines held values of their own; what the scenario asks for matters most."""
    rows = [
        (source, row)
        for source in run.record.sources
        for row in source.audit
        if state_of(row) == UNSET
    ]
    rows.sort(key=lambda pair: pair[1].scenario_value is None)
    cells = tuple(
        (
            source.name, runs.mode_words(source.contact), row.quantity,
            numbers.plain(row.scenario_value), row.engine_parameter,
            numbers.plain(row.read_value), _unit(row),
            row.note if row.read_value is None else "",
        )
        for source, row in rows
    )  # fmt: skip
    title = "Where an engine was left as it comes, it held values of its own"
    table = Table(title, _UNSET_COLUMNS, (Group("", cells),))
    if not any(row[-1] for row in cells):
        table = table.without(["Note"])
    return table if cells else None


def _source(source: SourceRecord) -> Part:
    notices = (f"{source.status}: {source.reason}",) if source.reason else ()
    table = Table("", _COLUMNS, (Group("", tuple(map(_row, source.audit))),))
    return Part(
        _summary(source),
        notices=notices,
        notes=tuple(_notes(source)),
        code=source.noise,
        tables=(table,) if source.audit else (),
        folded=True,
    )


def _summary(source: SourceRecord) -> str:
    """Engine, version and mode, and how much of what it holds is not the scenario's value."""
    head = f"{source.name} {source.version or ''}".strip()
    text = f"{head}, {runs.mode_words(source.contact)}: "
    if not source.audit:
        return text + source.status
    states = [state_of(row) for row in source.audit]
    text += f"{len(states)} values"
    if unset := states.count(UNSET):
        text += f", ≠ {unset} the engine's own"
    if translated := states.count(TRANSLATED):
        text += f", ⇄ {translated} translated"
    return text


def _notes(source: SourceRecord) -> Iterator[str]:
    if source.mapping and source.contact not in SHOWN_LEVELS:
        yield f"Mapping rule: {source.mapping}"
    if source.velocity_offset_s:
        when = "after" if source.velocity_offset_s > 0 else "before"
        yield (
            "Velocities and rates are as the engine stores them: they belong to"
            f" {numbers.plain(1e3 * abs(source.velocity_offset_s), 3)} ms {when} the time of their"
            " sample."
        )
    yield from (f"Note: {note}" for note in source.notes)
    if source.noise:
        yield "It printed:"


def _row(row: AuditRow) -> tuple[str, ...]:
    return (
        row.quantity,
        numbers.plain(row.scenario_value),
        row.engine_parameter,
        numbers.plain(row.set_value),
        numbers.plain(row.read_value),
        _unit(row),
        _WORDS[state_of(row)],
        row.note,
    )


def _unit(row: AuditRow) -> str:
    return "" if row.unit == "1" else row.unit
