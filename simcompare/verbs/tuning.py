"""What ``tune`` gives to Python: the answers of engines, which show themselves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from simcompare.errors import InputError
from simcompare.reports.render import matplotlib_
from simcompare.reports.render.figures import Band, Figure, Panel, Series
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.shown import Shown
from simcompare.reports.render.styles import style_of
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.tuning.request import Request
from simcompare.tuning.statement import Statement

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

_COLUMNS = (
    Column("engine", text=True),
    Column("type in", text=True),
    Column("restitution"),
    Column("± scatter"),
    Column("sinks (mm)"),
    Column("lasts (ms)"),
    Column("what to know", text=True),
)


@dataclass(frozen=True)
class TuneResult:
    """One engine's answer to one request.

    Attributes:
        engine: its name.
        version: its version, ``None`` where it is not installed.
        request: what was goal.
        status: "ok", "unsupported", "missing" or "failed".
        reason: one sentence where the status is not "ok"; the nearest that can be had is in it.
        statement: what to type in, and what it does; ``None`` where the status is not "ok".
        snippet: lines to copy into a loop of one's own; empty where only the settings are known.
        about: which pairs of a scenario it is for.
        notes: in what the drop stands for something else than the scene.
    """

    engine: str
    version: str | None
    request: Request
    status: str
    reason: str | None = None
    statement: Statement | None = None
    snippet: str = ""
    about: str = ""
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"{self.engine}: {self.reason or ', '.join(_typed(self.statement))}"


class Tuning(Shown, tuple[TuneResult, ...]):
    """One answer for every engine and restitution.

    A notebook shows them as a table. Besides::

        found = simcompare.tune(restitution=0.8, step="2ms")
        found.plot()  # restitution over the speed of the impact
        print(found[0].snippet)  # lines to copy
    """

    __slots__ = ()

    def plot(self) -> Canvas:
        """The restitution over the speed of the impact, a panel for each that was asked for.

        Raises:
            InputError: no engine has an answer over a range of speeds.
        """
        figure = self._figure()
        if figure is None:
            fault = 'no engine has an answer at several speeds; speed="0.5..4" asks for some'
            raise InputError("plot", [fault])
        return matplotlib_.canvas(figure)

    def _asked(self) -> Iterator[list[TuneResult]]:
        """The answers to each request."""
        for asked in dict.fromkeys((row.about, row.request) for row in self):
            yield [row for row in self if (row.about, row.request) == asked]

    def _figure(self) -> Figure | None:
        panels = tuple(_panel(rows) for rows in self._asked())
        if not any(len(series.x) > 1 for panel in panels for series in panel.series):
            return None
        return Figure("restitution", "Restitution over the speed of the impact", "", panels, True)

    def _glance(self) -> Glance:
        groups = tuple(Group(_title(rows[0]), tuple(map(_row, rows))) for rows in self._asked())
        made = Table("", _COLUMNS, groups if len(groups) > 1 else (Group("", groups[0].rows),))
        faults = any(row[-1] for group in groups for row in group.rows)
        notes = dict.fromkeys(note for row in self for note in row.notes)
        return Glance(
            title="Numbers for a restitution",
            sentences=tuple(_sentence(rows) for rows in self._asked()),
            table=made if faults else made.without([_COLUMNS[-1].head]),
            notes=tuple(notes),
            figure=self._figure(),
            more="More: .table(), .plot(), [0].snippet",
        )


def _title(row: TuneResult) -> str:
    asked = row.request
    low, high = asked.lowest_m_s, asked.highest_m_s
    speeds = f"{low:.3g} m/s" if low == high else f"{low:g} to {high:g} m/s"
    wanted = "numbers given" if asked.restitution is None else f"restitution {asked.restitution:g}"
    about = f"{row.about}, " if row.about else ""
    return f"{about}{wanted}, {row.request.level}, {speeds}, step {1e3 * asked.step_s:.4g} ms"


def _sentence(rows: Sequence[TuneResult]) -> str:
    holding = [row.engine for row in rows if row.statement and not row.statement.fault]
    return f"{_title(rows[0])}: holds in {', '.join(holding) or 'no engine'}."


def _typed(found: Statement | None) -> list[str]:
    """What is typed in for the restitution."""
    typed = () if found is None else found.typed
    return [f"{one.parameter} {one.value:.7g}" for one in typed if one.is_tuned]


def _row(row: TuneResult) -> tuple[str, ...]:
    found = row.statement
    if found is None or not found.bounces:
        return row.engine, ", ".join(_typed(found)), "–", "–", "–", "–", row.reason or "no bounce"
    means = [one.restitution for one in found.bounces]
    ends = dict.fromkeys(f"{value:.3f}" for value in (min(means), max(means)))
    return (
        row.engine,
        ", ".join(_typed(found)),
        " to ".join(ends),
        f"{max(one.scatter for one in found.bounces):.2g}",
        f"{1e3 * max(one.penetration_m for one in found.bounces):.2g}",
        f"{1e3 * max(one.contact_s for one in found.bounces):.2g}",
        found.fault,
    )


def _panel(rows: Sequence[TuneResult]) -> Panel:
    request = rows[0].request
    series = tuple(_series(row.engine, row.statement) for row in rows if row.statement)
    bands: tuple[Band, ...] = ()
    if request.restitution is not None:
        half = request.within * request.restitution
        ends = request.restitution - half, request.restitution + half
        bands = (Band(*ends, f"within {100 * request.within:.3g} %", request.restitution),)
    return Panel(
        rows[0].about, "speed of the impact (m/s)", "restitution", series, bands, log_x=True
    )


def _series(engine: str, found: Statement) -> Series:
    columns = [(one.speed_m_s, one.restitution, one.scatter) for one in found.bounces]
    x, y, u = np.array(columns).reshape(-1, 3).T
    return Series(engine, x, y, style_of(engine), u, points=True)
