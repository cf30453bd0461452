"""What a result does in Python: it shows itself in a notebook, and gives its table."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from simcompare.errors import UnknownName
from simcompare.reports.render import frames, matplotlib_
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.glance import Glance, html, text
from simcompare.reports.render.tables import Table

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure as Canvas


def plotted(figures: Iterable[Figure], name: str | None) -> Canvas:
    """One of the figures by its name, for Python; the first where ``None``.

    Raises:
        UnknownName: there is no such figure.
    """
    known = {figure.name: figure for figure in figures}
    chosen = next(iter(known), "") if name is None else name
    if chosen not in known:
        raise UnknownName("figure", chosen, known)
    return matplotlib_.canvas(known[chosen])


class Shown:
    """Something that shows itself; a subclass says what of it by :meth:`_glance`."""

    def _glance(self) -> Glance:
        raise NotImplementedError

    def table(self) -> pd.DataFrame:
        """What the notebook shows, as a table of pandas."""
        return frames.frame(self._glance().table or Table("", (), ()))

    def __repr__(self) -> str:
        return text(self._glance())

    def _repr_html_(self) -> str:
        return html(self._glance())
