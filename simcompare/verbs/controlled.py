"""What ``control`` gives to Python: a trajectory that shows itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from simcompare.arguments import checked
from simcompare.errors import UnknownName
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Array, Trajectory
from simcompare.reports.render import matplotlib_, numbers
from simcompare.reports.render.figures import Figure, Panel, Series
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.render.styles import style_of
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results import frames

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure as Canvas

_HEADS = ("what it is", "start", "end", "lowest", "highest")


@dataclass(frozen=True, repr=False)
class Controlled(Shown, Trajectory):
    """A trajectory with a controller in the loop; ``table()`` has a row for each probe.

    Attributes:
        title: of the scenario.
        probes: what the scenario observes, by name, the leading one first.
        cautions: what of a robot is left out, each without a full stop.
    """

    title: str = ""
    probes: Mapping[str, Probe] = field(default_factory=dict)
    cautions: tuple[str, ...] = ()

    def samples(self) -> pd.DataFrame:
        """Time, probes and every signal, one row a sample."""
        import pandas as pd

        return pd.DataFrame(self._columns())

    @checked
    def plot(self, name: str | None = None) -> Canvas:
        """A probe or a column of the samples over time; the first probe where ``None``.

        Raises:
            UnknownName: there is none of that name; names those that there are.
        """
        return matplotlib_.canvas(self._figure(name))

    def _columns(self) -> dict[str, Array]:
        return frames.columns(self, self.probes)

    def _figure(self, name: str | None) -> Figure:
        columns = self._columns()
        _, *known = columns
        chosen = known[0] if name is None else name
        if chosen not in known:
            raise UnknownName("probe or signal", chosen, known)
        probe = self.probes.get(chosen)
        title = probe.label if probe else chosen
        label = f"{probe.label} ({probe.unit})" if probe else chosen
        line = Series(self.source, self.time_s, columns[chosen], style_of(self.source))
        return Figure(chosen, title, "", (Panel(title, "time (s)", label, (line,)),))

    def _glance(self) -> Glance:
        columns = self._columns()
        rows = tuple(
            (name, probe.label, *map(_number, _ends(columns[name])))
            for name, probe in self.probes.items()
            if name in columns
        )
        heads = [Column(head, text=head == _HEADS[0]) for head in _HEADS]
        return Glance(
            title=f"{self.title}, controlled in {self.source} ({self.contact})",
            sentences=(
                f"{len(self.time_s)} samples to {self.time_s[-1]:g} s.",
                *(f"Caution: {caution}." for caution in self.cautions),
            ),
            table=Table("", (Column("probe", text=True), *heads), (Group("", rows),)),
            figure=self._figure(None),
            more="More: .table(), .plot(name), .samples()",
        )


def _ends(values: Array) -> tuple[float, ...]:
    """Start, end, lowest and highest."""
    return tuple(float(v) for v in (values[0], values[-1], values.min(), values.max()))


def _number(value: float) -> str:
    return numbers.plain(value, 4)
