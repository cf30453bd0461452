"""Blobs of the pictures of a film, and the path that one ball can take through them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

#: pictures in which a ball may not be seen on its way
_LOST = 4
#: blob and picture from which a path comes, with its worth
_Step = tuple[float, int, int]


@dataclass(frozen=True)
class Blob:
    """What differs from the wall.

    Attributes:
        x: of its centre, from the left [px].
        y: from the top [px].
        area: that it covers [px²].
        weight: how much it differs, 0 … 1.
    """

    x: float
    y: float
    area: float
    weight: float


def followed(blobs: Sequence[Sequence[Blob]]) -> list[Blob | None]:
    """The path of blobs with the largest worth: large and clear, near to each other in time."""
    worth: list[dict[int, _Step]] = []
    reach = _reach(blobs)
    for i, own in enumerate(blobs):
        row = {}
        for k, blob in enumerate(own):
            best = (0.0, -1, -1)
            for back in range(1, min(i, _LOST) + 1):
                for j, (value, _, _) in worth[i - back].items():
                    step = _cost(blobs[i - back][j], blob, back, reach)
                    best = max(best, (value - step, i - back, j))
            row[k] = (best[0] + blob.weight * math.sqrt(blob.area), best[1], best[2])
        worth.append(row)
    return _traced(blobs, worth)


def _traced(
    blobs: Sequence[Sequence[Blob]], worth: Sequence[dict[int, _Step]]
) -> list[Blob | None]:
    chosen: list[Blob | None] = [None] * len(blobs)
    ends = [(row[k][0], i, k) for i, row in enumerate(worth) for k in row]
    if not ends:
        return chosen
    _, i, k = max(ends)
    while i >= 0:
        chosen[i] = blobs[i][k]
        _, i, k = worth[i][k]
    return chosen


def _reach(blobs: Sequence[Sequence[Blob]]) -> float:
    """How far a ball may go from one picture to the next without being another one [px]."""
    radii = [math.sqrt(own[0].area / math.pi) for own in blobs if own]
    return 4 * float(np.median(radii)) if radii else 1.0


def _cost(one: Blob, other: Blob, steps: int, reach: float) -> float:
    """What it costs to be the same ball: nothing nearby, more with the way and another size."""
    way = math.hypot(other.x - one.x, other.y - one.y) / (reach * steps)
    size = abs(math.log(other.area / one.area))
    mean = math.sqrt((one.area + other.area) / 2) * (one.weight + other.weight) / 2
    return mean * (max(way - 1, 0.0) + 0.5 * max(size - 0.7, 0.0) + 0.1 * (steps - 1))
