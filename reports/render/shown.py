"""What a result does in Python: it shows itself in a notebook, and gives its table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from simcompare.reports.render import frames
from simcompare.reports.render.glance import Glance, html, text
from simcompare.reports.render.tables import Table

if TYPE_CHECKING:
    import pandas as pd


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
