"""Tables of a report as tables of pandas, to be looked at and copied in a notebook."""

from __future__ import annotations

from typing import TYPE_CHECKING

from simcompare.reports.render.tables import Table, printable

if TYPE_CHECKING:
    import pandas as pd


def frame(table: Table) -> pd.DataFrame:
    """The cells as they are read, with the first column, below its group, as names of the rows."""
    import pandas as pd

    if not table.columns:
        return pd.DataFrame()
    first, *rest = table.columns
    rows = [(group.title, *map(printable, row)) for group in table.groups for row in group.rows]
    grouped = any(group.title for group in table.groups)
    names: pd.Index = (
        pd.MultiIndex.from_tuples([row[:2] for row in rows], names=["", first.full_head])
        if grouped
        else pd.Index([row[1] for row in rows], name=first.full_head)
    )
    heads = [column.full_head for column in rest]
    made = pd.DataFrame([row[2:] for row in rows], index=names, columns=heads)
    made.attrs["title"] = table.title
    return made
