"""What the pictures of the experiments share: a line for each engine over steps and speeds."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from simcompare.characterization.behaviour import AtStep
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED
from simcompare.model.trajectory import Array
from simcompare.reports.render.figures import Band, Series, spread
from simcompare.reports.render.styles import style_of

Row = TypeVar("Row")
Step = TypeVar("Step", bound=AtStep)

#: titles of panels
LEVELS = {
    DEFAULT: "By default",
    COEFFICIENTS: "Coefficients typed in",
    TUNED: "Tuned",
    ASSISTED: "With our helps",
}
#: label of the axis of steps
STEP = "Step (ms)"
#: sideways shift of one engine against the next on a logarithmic axis [decades]
_APART = 0.09


@dataclass(frozen=True)
class Curve(Generic[Row]):
    """What is drawn of a row: where, how high, and half its bar; NaN where there is nothing."""

    x: Callable[[Row], float]
    y: Callable[[Row], float]
    u: Callable[[Row], float] | None = None


def answered(rows: Sequence[Step]) -> list[Step]:
    """Rows of steps at which there is something."""
    return [row for row in rows if not row.reason]


def series_of(found: Mapping[str, Sequence[Row]], curve: Curve[Row]) -> tuple[Series, ...]:
    """One line for each engine that has something to show."""
    lines = []
    for i, (name, rows) in enumerate(found.items()):
        x = np.array([curve.x(row) for row in rows]) * 10 ** spread(i, len(found), _APART)
        y = np.array([curve.y(row) for row in rows], dtype=float)
        y[~np.isfinite(y)] = math.nan
        u = None if curve.u is None else np.array([curve.u(row) for row in rows], dtype=float)
        if np.isfinite(y).any():
            lines.append(line_of(name, x, y, u))
    return tuple(lines)


def line_of(name: str, x: Array, y: Array, u: Array | None = None) -> Series:
    """The line of an engine."""
    return Series(name, x, y, style_of(name), u, points=True)


def wanted(value: float) -> tuple[Band, ...]:
    """The value that is right, as a line across a panel."""
    return (Band(value, value, "truth", value),)
