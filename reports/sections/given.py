"""What each engine was really given: the audit, and the rule by which it was translated."""

from __future__ import annotations

from typing import Any

from simcompare.model.settings import SHOWN_LEVELS
from simcompare.reports.render import numbers
from simcompare.reports.run import runs
from simcompare.reports.run.audit import LEFT, SAME, TRANSLATED, UNREAD, state_of
from simcompare.reports.sections.base import Section
from simcompare.results.records.run import SourceRecord
from simcompare.results.run import Run

_WORDS = {
    SAME: "",
    LEFT: "≠ engine's own value",
    TRANSLATED: "⇄ translated",
    UNREAD: "? cannot be read back",
}


class Given(Section):
    """Scenario values beside the values that the engine held."""

    name, title, template = "given", "What each engine was given", "given.html"

    def context(self, run: Run) -> dict[str, Any]:
        """One table for each engine and mode, and what differs in the engines' defaults."""
        blocks = [_block(source) for source in run.record.sources]
        left = [
            {"source": block["name"], "mode": block["mode"], **row}
            for block in blocks
            for row in block["rows"]
            if row["state"] == LEFT
        ]
        # what the scenario asks for, such as the friction of a joint, matters most
        left.sort(key=lambda row: not row["asked"])
        return {"blocks": blocks, "left": left}


def _velocity(offset_s: float | None) -> str:
    """To which instant stored velocities belong, where it is not that of the sample."""
    if not offset_s:
        return ""
    when = "after" if offset_s > 0 else "before"
    return (
        f"Velocities and rates are as the engine stores them: they belong to"
        f" {numbers.plain(1e3 * abs(offset_s), 3)} ms {when} the time of their sample."
    )


def _block(source: SourceRecord) -> dict[str, Any]:
    rows = []
    for row in source.audit:
        state = state_of(row)
        rows.append(
            {
                "quantity": row.quantity,
                "wanted": numbers.plain(row.scenario_value),
                "parameter": row.engine_parameter,
                "given": numbers.plain(row.set_value),
                "held": numbers.plain(row.read_value),
                "unit": "" if row.unit == "1" else row.unit,
                "note": row.note,
                "read": row.read_value is not None,
                "asked": row.scenario_value is not None,
                "state": state,
                "words": _WORDS[state],
            }
        )
    return {
        "name": source.name,
        "version": source.version,
        "mode": runs.mode_words(source.contact),
        "status": source.status,
        "reason": source.reason,
        "mapping": source.mapping if source.contact not in SHOWN_LEVELS else "",
        "velocity": _velocity(source.velocity_offset_s),
        "notes": source.notes,
        "noise": source.noise,
        "rows": rows,
        "left": sum(row["state"] == LEFT for row in rows),
        "translated": sum(row["state"] == TRANSLATED for row in rows),
    }
