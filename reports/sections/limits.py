"""Known limits of the engines, with references."""

from __future__ import annotations

from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results.run import Run


def limits(run: Run) -> Part | None:
    """The limits of each engine once; ``None`` where none is known."""
    engines = {source.name: source.known_limits for source in run.record.sources}
    groups = tuple(
        Group(name, tuple((limit.text, limit.reference) for limit in known))
        for name, known in engines.items()
        if known
    )
    columns = Column("Limit", text=True), Column("Documented or measured", text=True)
    table = Table("", columns, groups)
    if not groups:
        return None
    engine = "engine" if len(groups) == 1 else "engines"
    finding = f"{sum(len(group.rows) for group in groups)} limits of {len(groups)} {engine}"
    return Part(
        "Known limits", "limits", tables=(table,), folded=True, finding=finding, brief=False
    )
