"""What range sensors of many zones saw, as pictures whose near zones are dark."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from simcompare.model.trajectory import Array, Trajectory
from simcompare.reports.render.figures import GREYS, Figure, Matrix, Panel, Series
from simcompare.reports.run import runs
from simcompare.results.run import Run

#: how signals of such sensors end
_RANGES = ".range_m"


def range_figures(run: Run) -> tuple[Figure, ...]:
    """A figure for each range sensor: at the start, at the end or where a source is most off."""
    first = runs.truth(run) or next((one.trajectory for one in run.trajectories), None)
    signals = () if first is None else tuple(n for n in first.signals if n.endswith(_RANGES))
    return tuple(_figure(run, first, signal) for signal in signals if first is not None)


def _figure(run: Run, first: Trajectory, signal: str) -> Figure:
    pictures = first.signals[signal]
    far = float(pictures.max())
    worst = max(_others(run, first, signal), key=lambda one: one[0], default=None)
    last = len(pictures) - 1 if worst is None else worst[2]
    panels = [
        panel(f"{first.source}, {first.time_s[i]:g} s", pictures[i], far)
        for i in dict.fromkeys((0, last))
    ]
    caption = (
        "Each cell is a zone, as the sensor sees it, with its distance in m along the axis; near"
        " ones are dark."
    )
    if worst is not None:
        _, whose, i, picture = worst
        panels.append(panel(f"{whose}, {first.time_s[i]:g} s", picture, far))
        caption += f" On the right, where any source is most off: {whose}."
    right = panels[-1]
    assert right.matrix is not None
    panels[-1] = replace(right, matrix=replace(right.matrix, bar="distance (m)"))
    name = signal.removesuffix(_RANGES)
    title = f"What {name} saw"
    return Figure(f"ranges-{name}", title, caption, tuple(panels), height=1.1)


def _others(run: Run, first: Trajectory, signal: str) -> Iterator[tuple[float, str, int, Array]]:
    """How far each source is off at its worst sample, who it is, and what it saw then."""
    true = first.signals[signal]
    for mode in runs.modes(run):
        for name in runs.ran(run, mode):
            one = runs.nominal(run, name, mode)
            if one is None or one is first or one.signals.get(signal, true[:0]).shape != true.shape:
                continue
            off = np.abs(one.signals[signal] - true).max(axis=1)
            i = int(off.argmax())
            if off[i] > 0.001:
                yield float(off[i]), f"{name}, {mode}", i, one.signals[signal][i]


def panel(
    title: str, picture: Array, far: float, marks: tuple[Series, ...] = (), bar: str = ""
) -> Panel:
    """The zones of one instant (z,) [m] as cells, dark where near, white from ``far`` on.

    Args:
        title: of the panel.
        picture: distances along the axis; NaN leaves a cell empty.
        far: the largest distance of all panels beside each other [m].
        marks: drawn into cells.
        bar: what the scale of greys is called; empty for none.
    """
    side = math.isqrt(len(picture))
    ticks = tuple(str(i + 1) for i in range(side))
    cells = Matrix(picture.reshape(side, side), 2, (0.0, far), GREYS, empty="", bar=bar)
    return Panel(title, "column, from the left", "row, from the top", marks, x_ticks=ticks,
                 y_ticks=ticks, matrix=cells)  # fmt: skip
