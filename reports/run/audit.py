"""What an engine holds, as the audit of a source tells it."""

from __future__ import annotations

from simcompare.model.audit import AuditRow
from simcompare.results.records.run import SourceRecord

SAME, UNSET, TRANSLATED, UNREAD = "same", "unset", "translated", "unread"
#: what each source says of its step
STEP = "engine step_s"


def state_of(row: AuditRow) -> str:
    """Whether the engine holds the scenario's value, its own, or a translation of it."""
    wanted, given, held = row.scenario_value, row.set_value, row.read_value
    if held is None:
        return UNSET if given is None else UNREAD
    if wanted is None or abs(wanted - held) <= 1e-9 * max(abs(wanted), abs(held)):
        return SAME
    return UNSET if given is None else TRANSLATED


def keeps_its_own(source: SourceRecord, quantity: str) -> bool:
    """Whether an engine was left a value of its own where the scenario asks for another one."""
    rows = [row for row in source.audit if row.quantity == quantity]
    return any(row.scenario_value is not None and state_of(row) == UNSET for row in rows)


def step_of(source: SourceRecord) -> float | None:
    """The step that an engine holds [s], else that it was given; ``None`` where neither is told."""
    for row in source.audit:
        if row.quantity == STEP:
            step_s = row.set_value if row.read_value is None else row.read_value
            return None if step_s is None else float(step_s)
    return None
