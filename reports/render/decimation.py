"""Long lines with as many points as can be seen."""

from __future__ import annotations

import itertools
import math

import numpy as np

from simcompare.model.trajectory import Array

#: a line of more points than this is thinned out before it is drawn
MAX_POINTS = 5000


def decimated(x: Array, y: Array, most: int = MAX_POINTS) -> tuple[Array, Array]:
    """At most so many points of a line: the lowest and highest of every bin, and its gaps.

    Impacts stay as sharp as they are, which even thinning would round off.
    """
    if len(y) <= most:
        return x, y
    edges = np.linspace(0, len(y), max(most // 3, 1) + 1).astype(int)
    keep = {0, len(y) - 1}
    gaps = ~np.isfinite(y)
    low, high = np.where(gaps, math.inf, y), np.where(gaps, -math.inf, y)
    for begin, end in itertools.pairwise(edges):
        if gaps[begin:end].any():
            keep.add(int(begin + np.argmax(gaps[begin:end])))
        keep.add(int(begin + np.argmin(low[begin:end])))
        keep.add(int(begin + np.argmax(high[begin:end])))
    chosen = np.array(sorted(keep))
    return x[chosen], y[chosen]
