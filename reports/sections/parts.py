"""What the sections of both kinds of fits are filled with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from simcompare.notation import sentence
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.tables import Table, printable


def parts_of(
    figures: Sequence[Figure | None], tables: Sequence[Table | None], *notes: str
) -> dict[str, Any]:
    """Figures, tables and remarks, as far as there are any."""
    return {
        "figures": [figure for figure in figures if figure is not None],
        "grids": [table for table in tables if table is not None],
        "notes": [sentence(printable(note)) for note in notes if note],
    }
