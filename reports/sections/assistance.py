"""What each of our helps changes: the result with it, and without it."""

from __future__ import annotations

from typing import Any

from simcompare.engine.helps import HELPS
from simcompare.reports import numbers, runs
from simcompare.reports.sections.base import Section
from simcompare.reports.sections.parts import parts_of
from simcompare.reports.tables import Column, Group, Table
from simcompare.results import Run

_COLUMNS = (
    Column("Engine", text=True),
    Column("Measure", text=True),
    Column("With"),
    Column("Without"),
    Column("Truth"),
)
#: measures of the leading kind that are shown of each help
_SHOWN = 4


class Assistance(Section):
    """Every help that acted, with the nominal repeat that left it out."""

    name, title, template = "helps", "What our helps change", "real_part.html"

    def context(self, run: Run) -> dict[str, Any] | None:
        """One group of rows for each help; ``None`` where none acted."""
        left_out = run.record.get("without") or []
        if not left_out:
            return None
        lead = runs.measures(run)[:_SHOWN]
        groups = []
        for name in HELPS:
            rows = []
            for item in (item for item in left_out if item["help"] == name):
                if item["status"] != "ok":
                    rows.append((item["source"], item["reason"] or item["status"], "", "–", ""))
                    continue
                shown = {row["measure"]: row for row in item["measures"]}
                rows += [
                    (
                        item["source"],
                        runs.measure_words(measure) + runs.unit_words(shown[measure]["unit"]),
                        *(numbers.plain(shown[measure][k]) for k in ("with", "without", "truth")),
                    )
                    for measure in lead
                    if measure in shown
                ]
            if rows:
                groups.append(Group(f"{name}: {HELPS[name]}", tuple(rows)))
        note = "The nominal repeat alone, without one help at a time, all others kept."
        return parts_of([], [Table("", _COLUMNS, tuple(groups), note)])
