"""The parameters with which tosses land best, on a grid that is made finer, and how well so.

What is fitted is the mean distance of the eight corners over all samples and tosses, in which place
and turn are one length. It is not smooth: a box that falls on another face is a jump. So neighbours
along each axis are tried until none is better, then the grid is halved.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simcompare import units
from simcompare.fitting.tosses.tosses import Errors
from simcompare.model.fittable import Grid
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_tosses import TossMean, TossParameter

#: costs that differ by a smaller part are the same
_SAME = 1e-9
#: how often the grid is halved
HALVINGS = 3
#: draws of the bootstrap, and the part of them inside an interval
DRAWS, INSIDE = 2000, 0.95
Point = tuple[float, ...]


def interval(values: Sequence[float], seed: int = 0) -> TossMean:
    """Mean over tosses with its interval, by a bootstrap over the tosses."""
    held = np.asarray(values, dtype=float)
    ends = _ends(held[_drawn(len(held), seed)].mean(axis=1))
    return TossMean(float(held.mean()), float(held.std()), ends)


def _drawn(count: int, seed: int) -> NDArray[np.int64]:
    """Numbers of the tosses of every draw (DRAWS, count)."""
    return np.random.default_rng(seed).integers(0, count, (DRAWS, count))


def _ends(values: Array) -> tuple[float, float]:
    low, high = np.quantile(values, ((1 - INSIDE) / 2, (1 + INSIDE) / 2))
    return float(low), float(high)


@dataclass
class Search:
    """A search that says which points it wants, and is told how far the tosses are off there.

    Attributes:
        grids: parameter -> where it is sought.
        best: the best point so far.
        spacing: of the grid now.
        tried: point -> errors of every toss; ``None`` where the engine cannot.
    """

    grids: Mapping[str, Grid]
    best: Point
    halvings: int = HALVINGS
    tried: dict[Point, tuple[Errors, ...] | None] = field(default_factory=dict, repr=False)
    halved: int = 0
    ended: bool = False

    @property
    def spacing(self) -> tuple[float, ...]:
        """Spacing of the grid now."""
        return tuple(grid.spacing / 2**self.halved for grid in self.grids.values())

    def wanted(self) -> list[Point]:
        """Points that are to be tried next; none where the search has ended."""
        while not self.ended:
            around = self._neighbours()
            new = [point for point in (self.best, *around) if point not in self.tried]
            if new:
                return new
            nearest = min(around, key=self.cost)
            if self.cost(nearest) < self.cost(self.best):
                self.best = nearest
            elif self.halved < self.halvings:
                self.halved += 1
            else:
                self.ended = True
        return []

    def cost(self, point: Point) -> float:
        """Mean distance of the corners at a point [% of the width]."""
        errors = self.tried[point]
        return math.inf if errors is None else float(np.mean([one.corners for one in errors]))

    def values(self, point: Point) -> dict[str, float]:
        """A point by the names of its parameters."""
        return dict(zip(self.grids, point, strict=True))

    def _neighbours(self) -> list[Point]:
        found = []
        for i, (size, grid) in enumerate(zip(self.spacing, self.grids.values(), strict=True)):
            for side in (-1, 1):
                value = min(max(self.best[i] + side * size, grid.min), grid.max)
                value = float(f"{value:.9g}")  # the same point by another way is the same
                if value != self.best[i]:
                    found.append((*self.best[:i], value, *self.best[i + 1 :]))
        return found


def _is_untold(search: Search, axis: int) -> bool:
    """Whether a point that differs from the best one in this parameter alone is no worse."""

    def cost(point: tuple[float, ...]) -> float:
        errors = search.tried.get(point)
        return math.nan if errors is None else float(np.mean([one.corners for one in errors]))

    least = cost(search.best)
    return any(
        point[axis] != search.best[axis]
        and point[:axis] + point[axis + 1 :] == search.best[:axis] + search.best[axis + 1 :]
        and math.isclose(cost(point), least, rel_tol=_SAME)
        for point in search.tried
    )


def estimates(search: Search, seed: int = 0) -> dict[str, TossParameter]:
    """Every parameter's value with its interval.

    By a bootstrap over tosses: each draw has a best one among the points that were tried. The grid
    adds a triangular distribution of a spacing to both sides, as the neighbours are worse. Where
    one of them is no worse, the tosses do not tell the parameter: its interval is all of the grid.
    """
    points = [point for point, errors in search.tried.items() if errors is not None]
    corners = np.array([[one.corners for one in search.tried[p] or ()] for p in points])
    drawn = _drawn(corners.shape[1], seed)
    chosen = [int(np.argmin(corners[:, draw].mean(axis=1))) for draw in drawn]
    found = {}
    for i, (name, grid) in enumerate(search.grids.items()):
        every = np.array([point[i] for point in points])
        own, value, size = every[chosen], search.best[i], search.spacing[i]
        low, high = _ends(own)
        reached = bool(low <= every.min() or high >= every.max())
        ends = (max(min(low, value - size), grid.min), min(max(high, value + size), grid.max))
        u = math.hypot(float(own.std()), size / math.sqrt(6))
        if _is_untold(search, i):  # no toss touches anything: any value of the grid does as well
            ends, reached = (grid.min, grid.max), True
            u = (grid.max - grid.min) / math.sqrt(12)
        at_bound = value in (grid.min, grid.max)
        found[name] = TossParameter(
            value=value, u=u, interval95=ends, unit=units.unit_of(name), u_num=size / math.sqrt(6),
            spacing=size, open=reached, at_bound=at_bound,
        )  # fmt: skip
    return found
