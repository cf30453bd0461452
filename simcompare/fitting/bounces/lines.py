"""The straight line that most of some points share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array

#: points whose pairs propose lines
_PROPOSERS = 40


@dataclass(frozen=True)
class Line:
    """A line by least squares through the points near the one that most points share.

    Attributes:
        index: which points they are (n,).
        on: the points on it (n,).
        residual: of all points (n,).
        spread: standard deviation of a residual for one of 1 of a point (n,).
        slope: of the line.
        level: at the mean of the points' abscissas.
        middle: that mean.
    """

    index: NDArray[np.intp]
    on: NDArray[np.bool_]
    residual: Array
    spread: Array
    slope: float
    level: float
    middle: float


def shared(index: NDArray[np.intp], x: Array, y: Array, near: Array | float) -> Line:
    """The line that most points share.

    Args:
        index: which points they are (n,).
        x: (n,), two different ones at least.
        y: (n,).
        near: how far off a point may be, one or one each.
    """
    pick = np.unique(np.linspace(0, len(x) - 1, _PROPOSERS).round().astype(int))
    a, b = (pick[k] for k in np.triu_indices(len(pick), 1))
    slope = (y[b] - y[a]) / (x[b] - x[a])
    apart = np.abs(y - y[a][:, None] - slope[:, None] * (x - x[a][:, None]))
    counts = np.sum(apart <= near, axis=1)
    # of lines that equally many share the nearest
    best = np.lexsort((np.median(apart, axis=1), -counts))[0]
    on = apart[best] <= near
    middle = float(x[on].mean())
    design = np.column_stack((np.ones(len(x)), x - middle))
    covariance = np.linalg.inv(design[on].T @ design[on])
    level, steep = covariance @ design[on].T @ y[on]
    leverage = np.einsum("np,pq,nq->n", design, covariance, design)
    spread = np.sqrt(np.maximum(np.where(on, 1 - leverage, 1 + leverage), 0.0))
    residual = y - design @ np.array([level, steep])
    return Line(index, on, residual, spread, float(steep), float(level), middle)
